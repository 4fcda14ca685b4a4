"""What a command says: the result on stdout, everything else on stderr."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from labcal.run.progress import NoProgress, Progress

if TYPE_CHECKING:
    from rich.console import Console

_WIDTH_OF_A_FILE = 200
"""Columns for tables where no terminal says how wide it is."""


class Session:
    """The mouth of a command.

    Parameters
    ----------
    json : bool
        The result is one JSON document.
    quiet : bool
        No messages and no progress bar; results, warnings and errors are still told.
    """

    def __init__(self, *, json: bool = False, quiet: bool = False) -> None:
        self.json = json
        self.quiet = quiet
        self._stdout = sys.stdout
        self._emitted = False

    def emit(self, result: object, text: object) -> None:
        """Give the result, once.

        Parameters
        ----------
        result : pydantic model or dataclass
            The JSON document; NaN in it becomes null.
        text : str or rich renderable
            The same for people.
        """
        if self._emitted:
            raise RuntimeError("A command gives one result; emit was called twice.")
        if self.json:
            self._write_json(result)
        else:
            self._write(_rendered(text, self._stdout))
        self._emitted = True

    def say(self, message: object) -> None:
        """Tell a person what happens; silent with ``--quiet``."""
        if not self.quiet:
            sys.stderr.write(_rendered(message, sys.stderr))

    def warn(self, message: str) -> None:
        """Tell a person what should not be missed."""
        sys.stderr.write(_rendered(f"warning: {message}", sys.stderr))

    def fail(self, message: str, document: object) -> None:
        """Tell of an error; the document is left out where a result has been given already."""
        sys.stderr.write(_rendered(f"error: {message}", sys.stderr))
        if self.json and not self._emitted:
            self._write_json(document)

    @contextmanager
    def progress(self) -> Iterator[Progress]:
        """Give a progress bar on stderr; a silent one where nobody watches."""
        if self.quiet or not sys.stderr.isatty():
            yield NoProgress()
            return
        from labcal.cli.progress import RichProgress

        with RichProgress(_console(sys.stderr)) as bar:
            yield bar

    def _write_json(self, document: object) -> None:
        from labcal.run.json_text import to_json

        self._write(to_json(document))

    def _write(self, text: str) -> None:
        """Write to stdout so that a full disk or a reader gone shows now, not when the interpreter ends."""
        try:
            self._stdout.write(text)
            self._stdout.flush()
        except OSError:
            # What is left in the buffer would fail again, and an error document would, too.
            os.dup2(os.open(os.devnull, os.O_WRONLY), self._stdout.fileno())
            self._emitted = True
            raise


def _console(stream: Any) -> "Console":  # noqa: ANN401 - rich and the standard library disagree on IO[str]
    """Return a console that prints text as it is."""
    from rich.console import Console

    width = None if stream.isatty() else _WIDTH_OF_A_FILE
    return Console(file=stream, markup=False, highlight=False, emoji=False, width=width)


def _rendered(content: object, stream: Any) -> str:  # noqa: ANN401 - as above
    """Return a text with its lines unbroken, or a table within the width, as `stream` shows it."""
    console = _console(stream)
    with console.capture() as captured:
        console.print(content, soft_wrap=isinstance(content, str))
    return captured.get()
