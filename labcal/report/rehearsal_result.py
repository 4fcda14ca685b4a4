"""Result of ``labcal rehearse``: the JSON document."""

from dataclasses import dataclass

import numpy as np

from labcal.calibrate.dot_treatment import DotTreatment
from labcal.guide.rehearsal.confirmation import Confirmation
from labcal.guide.rehearsal.forecast import rms
from labcal.guide.rehearsal.limits import Limit
from labcal.guide.rehearsal.rehearsal import Rehearsal
from labcal.paths import AnyPath


@dataclass(frozen=True)
class LimitResult:
    """A limit in the JSON document."""

    name: str
    change: str
    """The change that halves it."""
    before_mm: float
    after_mm: float
    """RMS 3-D error after the change; null where the changed rig cannot be calibrated."""
    gain: float
    """Share by which the error falls."""
    why_not: str | None


@dataclass(frozen=True)
class BoardResult:
    """A size of the target in the JSON document."""

    scale: float
    """Of the planned target."""
    size_mm: tuple[float, float]
    dot_px: float
    """Median minor semi-axis of its dots."""
    coverage: float
    """Share of the picture that the dots span in the median view."""
    found: float
    """Share of the dots that the detector measures in drawn pictures."""
    rms_mm: float
    why_not: str | None


@dataclass(frozen=True)
class ConfirmationResult:
    """The rendered rig in the JSON document."""

    sets: int
    """Shoots that were rendered and calibrated."""
    views: int
    """Views that calibrated each."""
    points: int
    freed: int
    """Sets whose calibration freed the dots."""
    renderer_px: float
    """Standard deviation of a coordinate of a dot by the renderer's finitely many rays, which what is
    foretold here has in it."""
    dot_rms_px: float
    """RMS error of a coordinate of measured dots."""
    dot_expected_px: float
    """The same as foretold."""
    rms_mm: float
    """RMS 3-D error of the points of further views, in the frame of the first camera."""
    expected_mm: float
    range_mm: tuple[float, float]
    """Of the error after so many calibrations, in 95 of 100."""
    by_set_mm: list[float]
    shape_rms_mm: float
    """The same after a rigid alignment of each set onto the truth, as `labcal evaluate` does."""
    shape_expected_mm: float
    shape_range_mm: tuple[float, float]
    shape_by_set_mm: list[float]
    map_rank: float
    """Rank correlation of the map of errors of shape, found and foretold, in groups of points."""
    map_rank_lowest: float
    """That which a true forecast exceeds in 95 of 100, by the noise of so many points."""
    sets_needed: int
    """Fewest sets whose error in the frame of the first camera is within 15% of the expected one, in 95 of
    100."""
    holds: bool
    """True if both errors are as foretold, up to 15% or to what chance makes of so many sets."""


@dataclass(frozen=True)
class RehearseResult:
    """The JSON document of ``labcal rehearse``."""

    folder: str
    plan: str
    rms_mm: float
    """Expected RMS 3-D error over the working volume, in the frame of the first camera."""
    noise_mm: float
    """Its share by the pixels of the points themselves."""
    calibration_mm: float
    """Its share by the calibration."""
    depth_mm: float
    sideways_mm: float
    """RMS standard deviations in depth, and across (of one axis)."""
    range_mm: tuple[float, float]
    """Of the RMS error after a single calibration, in 95 of 100."""
    median_mm: float
    """RMS error that half of all single calibrations stay below."""
    shape_mm: float
    """Expected RMS 3-D error after a rigid alignment onto the truth: of shape and size alone."""
    shape_range_mm: tuple[float, float]
    """Of that after a single calibration, in 95 of 100."""
    other_poses_mm: list[float]
    """Expected RMS errors with other poses of the target that cover as much."""
    seen: float
    """Share of the working volume that all cameras see."""
    dot_px: float
    """Typical minor semi-axis of the target's dots."""
    dot_sigma_px: float
    """Standard deviation of a coordinate of a dot of that size."""
    dots_found: float
    """Share of the dots that the detector measures in drawn pictures."""
    views: int
    enough_views: int | None
    """Least number from which on twice as many bring less than a tenth; null if none does."""
    view_counts: list[tuple[int, float]]
    """Numbers of views, each with the RMS 3-D error after it."""
    limited_by: str
    limits: list[LimitResult]
    dot_places: str
    """Treatment of the dots by the calibration: freed or declared."""
    free_dots_mm: float | None
    """RMS 3-D error where the calibration estimates the dots' places, too; null where that does not apply."""
    keep_dots_mm: float | None
    """RMS 3-D error where the calibration takes the dots as declared; null for an exact print."""
    boards: list[BoardResult]
    best_board: float | None
    """Scale of the board with the least error of those that fit; null if none does."""
    confirmation: ConfirmationResult | None
    warnings: list[str]


def rehearse_result(folder: AnyPath, found: Rehearsal) -> RehearseResult:
    """Return the JSON document; `folder` is where everything is."""
    made, best = found.forecast, found.best_board
    whole = max(1, sum(one.whole for one in found.pictures))
    return RehearseResult(
        folder=str(folder),
        plan=found.plan.name,
        rms_mm=made.rms_mm,
        noise_mm=rms(np.sqrt(np.trace(made.noise, axis1=1, axis2=2))),
        calibration_mm=made.calibration_mm,
        depth_mm=rms(made.depth_mm),
        sideways_mm=rms(made.sideways_mm),
        range_mm=made.places.range_mm,
        median_mm=made.places.median_mm,
        shape_mm=made.shape_mm,
        shape_range_mm=made.shapes.range_mm,
        other_poses_mm=list(found.by_poses_mm),
        seen=float(made.seen.mean()),
        dot_px=found.noise.size_px,
        dot_sigma_px=float(np.sqrt(found.noise.variance)),
        dots_found=sum(one.found for one in found.pictures) / whole,
        views=len(found.views),
        enough_views=found.enough_views,
        view_counts=[(one.views, one.rms_mm) for one in found.counts],
        limited_by=found.limited_by,
        limits=[_limit(one) for one in found.limits],
        dot_places=made.dot_places.value,
        free_dots_mm=found.by_dot_places.get(DotTreatment.FREED),
        keep_dots_mm=found.by_dot_places.get(DotTreatment.DECLARED),
        boards=[
            BoardResult(
                one.scale, (one.width_mm, one.height_mm), one.dot_px, one.coverage, one.found, one.rms_mm,
                one.why_not or None,
            )
            for one in found.boards
        ],
        best_board=None if best is None else best.scale,
        confirmation=None if found.confirmation is None else _confirmation(found.confirmation),
        warnings=list(found.warnings),
    )  # fmt: skip


def _limit(one: Limit) -> LimitResult:
    return LimitResult(one.name.value, one.change, one.before_mm, one.after_mm, one.gain, one.why_not or None)


def _confirmation(one: Confirmation) -> ConfirmationResult:
    places, shape = one.places, one.shape
    return ConfirmationResult(
        sets=one.sets,
        views=one.views,
        points=one.points,
        freed=one.freed,
        renderer_px=one.renderer_px,
        dot_rms_px=one.dot_rms_px,
        dot_expected_px=one.dot_expected_px,
        rms_mm=places.rms_mm,
        expected_mm=places.expected_mm,
        range_mm=(places.lowest_mm, places.highest_mm),
        by_set_mm=list(places.by_set_mm),
        shape_rms_mm=shape.rms_mm,
        shape_expected_mm=shape.expected_mm,
        shape_range_mm=(shape.lowest_mm, shape.highest_mm),
        shape_by_set_mm=list(shape.by_set_mm),
        map_rank=one.map_rank,
        map_rank_lowest=one.map_rank_lowest,
        sets_needed=places.sets_needed,
        holds=one.holds,
    )
