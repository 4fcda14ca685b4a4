"""A file that a page holds and hands out."""

from collections.abc import Sequence
from dataclasses import dataclass

from labcal.report.page.asset import Asset
from labcal.run.tables import table_text


@dataclass(frozen=True)
class Download:
    """A file inside the page.

    Attributes
    ----------
    file : str
        The name that it gets when it is saved: ``residuals.csv``.
    text : str
        Its content.
    """

    file: str
    text: str

    @property
    def asset(self) -> Asset:
        """The content in the page."""
        return Asset(f"file-{self.file.replace('.', '-')}", self.text.encode())

    @property
    def label(self) -> str:
        """The text of its button: the kind of the file."""
        return self.file.rpartition(".")[2].upper()


MOST_LINES = 60_000
"""Of a table in a page, which stays below 10 MB."""


def table_download(file: str, header: Sequence[str], columns: Sequence[Sequence[object]]) -> Download:
    """Return a table as a file in a page; of very many lines every so many-th.

    Parameters
    ----------
    file : str
        Its name, which says so where lines are left out.
    header : sequence of str
    columns : sequence of sequences
        Of equal length.
    """
    lines = list(zip(*columns, strict=True))
    step = -(-len(lines) // MOST_LINES) or 1
    name, dot, ending = file.rpartition(".")
    kept = file if step == 1 else f"{name}-1-of-{step}{dot}{ending}"
    return Download(kept, table_text(header, lines[::step]))
