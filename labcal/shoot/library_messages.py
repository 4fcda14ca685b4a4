"""Messages that compiled libraries print on stderr, captured instead of shown."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from tempfile import TemporaryFile

_STDERR = 2
_MOST_BYTES = 2**16


@dataclass
class LibraryMessages:
    """The beginning of what was printed; empty until the work is done."""

    text: str = ""


@contextmanager
def kept_messages() -> Iterator[LibraryMessages]:
    """Yield an object that receives the text printed on the file descriptor of stderr.

    libtiff, libpng, libjpeg and OpenEXR print a line for every damaged part of a picture, past
    ``sys.stderr``; a hostile file has thousands of them.
    """
    found = LibraryMessages()
    try:
        kept = os.dup(_STDERR)
    except OSError:  # there is no stderr
        yield found
        return
    if sys.stderr is not None:
        sys.stderr.flush()
    with TemporaryFile() as said:
        os.dup2(said.fileno(), _STDERR)
        try:
            yield found
        finally:
            os.dup2(kept, _STDERR)
            os.close(kept)
            said.seek(0)
            found.text = said.read(_MOST_BYTES).decode("utf-8", errors="replace")
