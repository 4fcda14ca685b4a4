"""A table in a page."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from markupsafe import Markup

from labcal.report.page.asset import Asset
from labcal.report.page.download import Download
from labcal.report.page.part import Part
from labcal.report.page.templates import rendered

MISSING = "–"  # noqa: RUF001 -- meant
"""A cell without a figure."""


class Side(StrEnum):
    """The side of a column on which its cells stand, which is also the name of their style."""

    LEFT = "text"
    WIDE = "text wide"
    """On the left, and wide enough for a sentence."""
    RIGHT = "figure"


@dataclass(frozen=True)
class Column:
    """A column.

    Attributes
    ----------
    heading : str
        With the unit.
    side : Side
    meaning : str
        What the heading leaves unsaid; shown when it is pointed at.
    """

    heading: str
    side: Side = Side.RIGHT
    meaning: str = ""


@dataclass(frozen=True)
class PageTable(Part):
    """A table. The first cell of each row names the row.

    Attributes
    ----------
    name : str
        Its id in the page.
    caption : str
    columns : sequence of Column
    rows : sequence of sequences of str
        As many cells as columns.
    data : Download, optional
        The same, and more, as a file.
    """

    name: str
    caption: str
    columns: Sequence[Column]
    rows: Sequence[Sequence[str]]
    data: Download | None = None

    def html(self) -> Markup:
        """Return the table, in a box that scrolls where the page is narrow."""
        return rendered("table.html.jinja", {"table": self})

    @property
    def assets(self) -> tuple[Asset, ...]:
        """The file."""
        return () if self.data is None else (self.data.asset,)
