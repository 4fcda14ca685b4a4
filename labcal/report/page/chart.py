"""A still figure in a page."""

from dataclasses import dataclass

from markupsafe import Markup

from labcal.report.page.asset import Asset
from labcal.report.page.download import Download
from labcal.report.page.part import Part
from labcal.report.page.templates import rendered


@dataclass(frozen=True)
class Chart(Part):
    """An SVG with its caption; the page saves it as a file, and its numbers as a table.

    Attributes
    ----------
    name : str
        Its id in the page, and the name of the file.
    svg : str
        The element, as :func:`~labcal.report.inline_svg.inline_svg` makes it.
    caption : str
    data : Download, optional
        The numbers that are drawn.
    """

    name: str
    svg: str
    caption: str
    data: Download | None = None

    def html(self) -> Markup:
        """Return the figure."""
        svg = Markup(self.svg)  # noqa: S704 -- made by matplotlib, or by this package, from numbers
        return rendered("chart.html.jinja", {"chart": self, "svg": svg})

    @property
    def assets(self) -> tuple[Asset, ...]:
        """The file of numbers."""
        return () if self.data is None else (self.data.asset,)
