"""Result of a reconstruction of named points."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from labcal.calibrate.systematic_residual import SystematicResidual
from labcal.calibrate.triangulation_check import TriangulationCheck
from labcal.correspond.named_points import NamedPoints
from labcal.paths import AnyPath
from labcal.public_object import HtmlTable, PublicObject
from labcal.reconstruct.found_marks import FoundMarks
from labcal.reconstruct.frames.fitted_frame import FittedFrame
from labcal.reconstruct.frames.framed_budget import FramedBudget
from labcal.reconstruct.point_budget import Budget, PointBudget
from labcal.reconstruct.scale.fitted_scale import FittedScale
from labcal.reconstruct.scale.scaled_budget import ScaledBudget

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True, eq=False, repr=False)
class NamedReconstruction(PublicObject):
    """Named points, and what speaks for and against them.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> found = pipeline.measure(examples.rig(), examples.pixels())
    >>> found.points.flag.tolist()
    ['ok', 'ok', 'ok', 'ok', 'ok']
    >>> found.warnings
    ()
    """

    points: NamedPoints
    miss_px: float | None
    """Median triangulation residual of points, px; infinite if their rays do not intersect; None if the model
    has no cameras."""
    check: TriangulationCheck | None
    """Comparison of the residuals with the value expected from the calibration; None without cameras."""
    systematic: SystematicResidual | None = None
    """Shifts, rotations and changes of scale of whole pictures in the residuals of points that all cameras
    see; None where these are fewer than 20, or the rig states no covariance."""
    frame: FittedFrame | None = None
    """The frame that the points are in; None if it is that of the model."""
    budget: PointBudget | FramedBudget | ScaledBudget | None = None
    """The shares of noise and calibration in the covariances, line by line, in the frame of the points; None
    if the model has no rig."""
    scale: FittedScale | None = None
    """The scale that scale bars gave; None without."""
    marks: FoundMarks | None = None
    """The marks that the points are of; None if they are of named pixels."""
    warnings: tuple[str, ...] = ()
    """Warnings in words."""

    def in_frame(self, frame: FittedFrame) -> "NamedReconstruction":
        """Return these points, which are in the world of their model, in a frame that they determine."""
        inside = self.with_noise
        points = frame.applied(inside)
        if not isinstance(self.budget, PointBudget | ScaledBudget):
            return replace(self, points=points, frame=frame)
        budget = FramedBudget(self.budget, inside, frame, points.covariance)
        if isinstance(self.budget, ScaledBudget):
            budget = replace(budget, noise=budget.whole_noise)
        if budget.kind is Budget.FULL or isinstance(self.budget, ScaledBudget):
            points = points.with_covariances(budget.noise + budget.calibration)
        return replace(self, points=points, frame=frame, budget=budget)

    @property
    def with_noise(self) -> NamedPoints:
        """The points with the covariances of their noise alone, in the world of the model."""
        if isinstance(self.budget, PointBudget) and self.budget.kind is Budget.FULL:
            return self.points.with_covariances(self.budget.noise)
        if isinstance(self.budget, ScaledBudget):
            return self.points.with_covariances(self.budget.noise)
        return self.points

    def save(self, path: AnyPath, *, force: bool = False) -> None:
        """Write the points as ``points.csv``, which :meth:`NamedPoints.load` reads.

        Raises
        ------
        OutputError
            The file exists and `force` is not set, or it cannot be written.
        """
        self.points.save(path, force=force)

    def to_pandas(self) -> "pandas.DataFrame":
        """Return the points as a table; as :meth:`NamedPoints.to_pandas`."""
        return self.points.to_pandas()

    def _html_tables(self) -> Sequence[HtmlTable]:
        flags = Counter(self.points.flag.tolist())
        return [
            HtmlTable(("flag", "points"), [[flag, str(count)] for flag, count in flags.items()]),
            HtmlTable(("warnings",), [[warning] for warning in self.warnings]),
        ]

    def _summary(self) -> Mapping[str, object]:
        summary: dict[str, object] = {"points": len(self.points), "ok": int(self.points.ok.sum())}
        if self.miss_px is not None:
            summary["median_residual"] = f"{self.miss_px:.3g} px"
        if self.frame is not None:
            summary["frame"] = self.frame.kind.value
        if self.scale is not None:
            summary["scale_error"] = f"{self.scale.error_ppm:.3g} ppm"
        if self.budget is not None:
            summary["budget"] = self.budget.kind.value
        return {**summary, "warnings": len(self.warnings)}
