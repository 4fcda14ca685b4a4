"""The output of a command: the result on stdout, everything else on stderr."""

import os
import shlex
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from labcal.cli.option_words import document_in_options, in_options
from labcal.cli.streams import Stream
from labcal.run.progress import NoProgress, Progress


class Session:
    """The output of a command.

    Parameters
    ----------
    stdout : text stream
        Where the result goes.
    json : bool
        The result is one JSON document.
    quiet : bool
        No messages and no progress bar; results, warnings and errors are still written.
    words : sequence of str
        The arguments of the command, beginning with its verb.
    """

    def __init__(
        self, stdout: Stream, *, json: bool = False, quiet: bool = False, words: Sequence[str] = ()
    ) -> None:
        self.command = shlex.join(["labcal", *words])
        self.json = json
        self.quiet = quiet
        self._stdout = stdout
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
            from labcal.cli.console import rendered

            self._write(rendered(text, self._stdout))
        self._emitted = True

    def say(self, message: object) -> None:
        """Write a message about progress; silent with ``--quiet``."""
        if not self.quiet:
            _write_message(message)

    def warn(self, message: str) -> None:
        """Write a warning."""
        _write_message(f"warning: {_in_one_line(in_options(message))}")

    def fail(self, message: str, document: object) -> None:
        """Report an error; the document is left out if a result has been given already."""
        _write_message(f"error: {_in_one_line(in_options(message))}")
        if self.json and not self._emitted:
            self._write_json(document)

    @contextmanager
    def progress(self) -> Iterator[Progress]:
        """Give a progress bar on stderr; a silent one where nobody watches."""
        if self.quiet or not sys.stderr.isatty():
            yield NoProgress()
            return
        from labcal.cli.console import console_for
        from labcal.cli.progress import RichProgress

        with RichProgress(console_for(sys.stderr)) as bar:
            yield bar

    def _write_json(self, document: object) -> None:
        from labcal.run.json_text import plain_data, to_json

        self._write(to_json(document_in_options(plain_data(document))))

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


def _in_one_line(message: str) -> str:
    """Return a message without line ends, so that no name in it begins a line of its own."""
    return " ".join(message.splitlines())


def _write_message(content: object) -> None:
    from labcal.cli.console import rendered

    sys.stderr.write(rendered(content, sys.stderr))
