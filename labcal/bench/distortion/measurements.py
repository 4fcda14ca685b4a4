"""All that a benchmark of distortion has measured, and what follows from it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from labcal.bench.distortion.case import Measured
from labcal.bench.distortion.cell_summary import CellSummary, summarised, usual_cells
from labcal.bench.distortion.checks import distortion_checks, failure_notes
from labcal.bench.distortion.curves import figures_of
from labcal.bench.distortion.lines import Line
from labcal.bench.distortion.network_answer import network_answer
from labcal.bench.distortion.own_detections.result import OwnResult
from labcal.bench.distortion.plan import Plan
from labcal.bench.distortion.protocols.result import ProtocolResult
from labcal.bench.distortion.rendered_curves import rendered_figures, rendered_notes
from labcal.bench.distortion.result import DistortionResult, family_figures
from labcal.bench.distortion.sensitivity import Sensitivity, sensitivities
from labcal.bench.distortion.sensitivity_figures import sensitivity_figures
from labcal.bench.distortion.winners import winners


@dataclass(frozen=True)
class Measurements:
    """Lines of a plan, and what was measured besides.

    Attributes
    ----------
    plan : Plan
    first_seed : int
    cases : int
        Number of cases.
    lines : sequence of Line
    detections : tuple of OwnResult
    protocols : tuple of ProtocolResult
    """

    plan: Plan
    first_seed: int
    cases: int
    lines: Sequence[Line]
    detections: tuple[OwnResult, ...] = ()
    protocols: tuple[ProtocolResult, ...] = ()

    @cached_property
    def summaries(self) -> list[CellSummary]:
        """The summaries of all cells."""
        return summarised(self.lines)

    @cached_property
    def usual(self) -> list[CellSummary]:
        """The summaries of cells with simulated points, in which nothing is wrong."""
        return usual_cells(self.summaries)

    @cached_property
    def rendered(self) -> list[CellSummary]:
        """The summaries of cells through pictures, in which nothing is wrong."""
        return [one for one in self.summaries if one.cell.is_pictured]

    @cached_property
    def sensitivity(self) -> list[Sensitivity]:
        """The sensitivity to faults."""
        return sensitivities(self.lines)

    def figures(self) -> dict[str, str]:
        """Return the figures: SVG texts by name."""
        return (
            figures_of(self.usual) | rendered_figures(self.rendered) | sensitivity_figures(self.sensitivity)
        )

    def result(self, *, quick: bool, command: str) -> DistortionResult:
        """Return the document ``results.json``.

        Parameters
        ----------
        quick : bool
            The plan is a short one.
        command : str
            The command line that measures the same again.
        """
        return DistortionResult(
            bench="distortion",
            quick=quick,
            command=command,
            checks=tuple(distortion_checks(self.summaries)),
            notes=(*failure_notes(self.summaries), *rendered_notes(self.rendered)),
            plan=self.plan,
            plan_sha256=self.plan.sha256,
            first_seed=self.first_seed,
            cases=self.cases,
            answer=tuple(network_answer(self.usual)),
            families=tuple(family_figures(self.usual)),
            winners=tuple(winners(self.usual)),
            outside=tuple(family_figures(self.usual, Measured.OUTSIDE)),
            sensitivity=tuple(self.sensitivity),
            rendered=tuple(family_figures(self.rendered)),
            detections=self.detections,
            protocols=self.protocols,
        )
