"""Findings of a benchmark of distortion, as the sections of its page read them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from labcal.bench.distortion.case import Layout, Measured
from labcal.bench.distortion.cell_summary import CellSummary, usual_cells
from labcal.bench.distortion.curves import with_figures
from labcal.bench.distortion.enough_points import least_of
from labcal.bench.distortion.levels import spread_levels
from labcal.bench.distortion.result import DistortionResult
from labcal.report.page.document import Section

_MOST_NOISES = 2
"""In a figure of the page; the files beside it have all."""


@dataclass(frozen=True)
class Findings:
    """Results and summaries of a benchmark, as the sections of its page read them.

    Attributes
    ----------
    result : DistortionResult
    summaries : sequence of CellSummary
        Of all cells, those with a fault or of other pixels, too.
    results_csv : str
        The text of ``results.csv``.
    """

    result: DistortionResult
    summaries: Sequence[CellSummary]
    results_csv: str = ""

    @property
    def usual(self) -> list[CellSummary]:
        """The summaries of cells with simulated points, in which nothing is wrong."""
        return usual_cells(self.summaries)

    @property
    def families(self) -> tuple[str, ...]:
        """The families in the order of the plan."""
        return self.result.plan.families

    @property
    def noises(self) -> list[float]:
        """The noises for which there is room in a figure, px."""
        return spread_levels(self.result.plan.noise_px, _MOST_NOISES)

    @property
    def enough(self) -> int:
        """The number of training points that figures over the strength are drawn for."""
        return least_of(self.result.plan.points)

    def cells(self, family: str, layout: Layout, region: Measured) -> list[CellSummary]:
        """Return the usual cells of a family, layout and region, of the chosen noises; none without a figure.

        Parameters
        ----------
        family : str
        layout : Layout
        region : Measured
        """
        return with_figures(
            [
                one
                for one in self.usual
                if (one.cell.family, one.cell.layout) == (family, layout) and one.cell.noise_px in self.noises
            ],
            region,
        )


MakeSection = Callable[[Findings], Section | None]
"""A section of the page; None where there is nothing to show in it."""
