"""The interactive 3-D view of a page: a still picture until somebody asks for more."""

from dataclasses import dataclass
from functools import cached_property

from markupsafe import Markup

from labcal.report.page.asset import Asset
from labcal.report.page.part import Part
from labcal.report.page.plotly_figure import layers, plotly_figure
from labcal.report.page.plotly_script import NAME, plotly_script
from labcal.report.page.templates import rendered
from labcal.report.space import Direction, Space
from labcal.report.space_figure import space_figure


@dataclass(frozen=True)
class SpaceView(Part):
    """Cameras, targets, points and their errors in space.

    Attributes
    ----------
    name : str
        Its id in the page.
    space : Space
    description : str
        What is to be seen, for those who cannot see it.
    """

    name: str
    space: Space
    description: str

    def html(self) -> Markup:
        """Return the still picture, and what starts and steers the 3-D view."""
        svg = Markup(space_figure(self.space, self.name, self.description))  # noqa: S704 -- made by matplotlib
        megabytes = f"{len(plotly_script().packed) / 1e6:.1f}"
        values = {"view": self, "svg": svg, "script": NAME, "megabytes": megabytes}
        return rendered("space_view.html.jinja", values)

    @property
    def assets(self) -> tuple[Asset, ...]:
        """The figure for plotly, and its script."""
        return Asset(f"{self.name}-figure", plotly_figure(self._shown).encode()), plotly_script()

    @cached_property
    def _shown(self) -> Space:
        return self.space.thinned()

    @property
    def directions(self) -> list[Direction]:
        """Directions of view, one a button."""
        return self._shown.directions

    @property
    def layers(self) -> tuple[str, ...]:
        """Layers that can be shown and hidden."""
        return layers(self._shown)

    @property
    def caption(self) -> str:
        """The description, with the scale of the error vectors."""
        text = self.description
        if len(self.space.vectors):
            text += f" Error vectors are drawn {self._shown.magnification:g} times as long as they are."
        left = len(self.space.points) - len(self._shown.points)
        return f"{text} {left} of the points are left out here." if left else text
