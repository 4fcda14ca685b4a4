"""A page as an output of a command or of a function."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from labcal.errors import OutputError
from labcal.paths import AnyPath, as_path
from labcal.report.page.document import PAGE_KIND, Page
from labcal.run.claims import FileOutput
from labcal.run.outputs import write_file

_LONGEST = 120
"""Letters of an argument in the text of a call."""
_ENDINGS = (".html", ".htm")


def _as_it_is(text: str) -> str:
    return text


@dataclass(frozen=True)
class PageOutput:
    """The place of a page, and the command that it names.

    Attributes
    ----------
    path : path
        Ends in ``.html``.
    force : bool
        Replace a page of labcal's that exists.
    command : str
        The command line that makes it again; empty where a function was called.
    phrase : callable
        What turns a message of the library into the reader's words; the command line speaks of options.
    inputs : tuple of path
        Files that were read; where none is named, those that the function was given by their paths.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> page = pipeline.PageOutput("errors.html", force=True)
    >>> errors = pipeline.evaluate(examples.points(), examples.TARGET, page=page)
    """

    path: AnyPath
    force: bool = False
    command: str = ""
    phrase: Callable[[str], str] = _as_it_is
    inputs: tuple[AnyPath, ...] = ()

    @classmethod
    def of(cls, given: "PageOutput | AnyPath") -> "PageOutput":
        """Return the output that is given, by its path, too."""
        return given if isinstance(given, PageOutput) else cls(given)

    @property
    def file(self) -> FileOutput:
        """The file, for :func:`~labcal.run.claims.claim_outputs`.

        Raises
        ------
        OutputError
            Its name does not end in ``.html``.
        """
        return page_file(self.path)

    def write(self, page: Page) -> None:
        """Write a page whole.

        Raises
        ------
        OutputError
            It exists and may not be replaced, or it cannot be written.
        """
        write_file(self.file.path, page.text(), kind=PAGE_KIND, force=self.force)


def is_page(path: AnyPath) -> bool:
    """Tell whether a name is that of a page."""
    return as_path(path).suffix.lower() in _ENDINGS


def page_file(path: AnyPath) -> FileOutput:
    """Return a page as a file to write.

    Raises
    ------
    OutputError
        Its name does not end in ``.html``.
    """
    place = as_path(path)
    if not is_page(place):
        raise OutputError(f"{place} cannot be written: it would be a page. Choose a name that ends in .html.")
    return FileOutput(place, PAGE_KIND)


def called(function: str, arguments: Mapping[str, object]) -> str:
    """Return a call of a function of the pipeline as text; objects without a short text are named by type.

    Parameters
    ----------
    function : str
    arguments : mapping of str to object
        Those that are None, or empty, are left out.
    """
    given = [f"{name}={_text(value)}" for name, value in arguments.items() if not _is_left_out(value)]
    return f"labcal.pipeline.{function}({', '.join(given)})"


def _is_left_out(value: object) -> bool:
    return value is None or (isinstance(value, tuple) and not value)


def _text(value: object) -> str:
    """Return a value as it is typed; what would be long, or cannot be typed, by its type."""
    if isinstance(value, Path):
        return repr(str(value))
    if isinstance(value, str | int | float) or (
        isinstance(value, Iterable) and not hasattr(value, "__array__")
    ):
        text = repr(value)
        return text if len(text) <= _LONGEST else f"<{type(value).__name__}>"
    return f"<{type(value).__name__}>"
