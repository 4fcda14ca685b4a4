"""Parts of a page beside each other."""

from dataclasses import dataclass

from markupsafe import Markup

from labcal.report.page.asset import Asset
from labcal.report.page.part import Part
from labcal.report.page.templates import rendered


@dataclass(frozen=True)
class Beside(Part):
    """Parts that stand beside each other where the page is wide enough, else below each other."""

    parts: tuple[Part, ...]

    def html(self) -> Markup:
        """Return the parts."""
        return rendered("beside.html.jinja", {"parts": self.parts})

    @property
    def assets(self) -> tuple[Asset, ...]:
        """Those of the parts."""
        return tuple(asset for part in self.parts for asset in part.assets)
