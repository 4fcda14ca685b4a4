"""stdout for results alone: what libraries print there goes to stderr."""

import contextlib
import os
import sys
from collections.abc import Iterator
from typing import Any, TypeAlias

Stream: TypeAlias = Any
"""A text stream; the checks at run time take no stream in memory for a TextIO."""


@contextlib.contextmanager
def result_stream() -> Iterator[Stream]:
    """Give a stream to the caller's stdout, and send all that others print there to stderr meanwhile.

    Mitsuba prints its log from C++, past ``sys.stdout``, so the file descriptor itself is turned. Text is
    written as UTF-8, as JSON asks for, unless it goes to a terminal.
    """
    original = sys.stdout
    try:
        descriptor = original.fileno()
    except (OSError, ValueError):  # a stream in memory, as in tests
        with contextlib.redirect_stdout(sys.stderr):
            yield original
        return
    original.flush()
    kept = os.dup(descriptor)
    encoding = original.encoding if original.isatty() else "utf-8"
    with os.fdopen(kept, "w", encoding=encoding, errors="backslashreplace") as results:
        os.dup2(sys.stderr.fileno(), descriptor)
        try:
            with contextlib.redirect_stdout(sys.stderr):
                yield results
        finally:
            results.flush()
            os.dup2(kept, descriptor)
