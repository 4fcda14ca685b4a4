"""Sizes of the target, and numbers of views: what each would bring."""

from dataclasses import dataclass, replace

import numpy as np

from labcal.arrays import Pose
from labcal.errors import InputError
from labcal.guide.rehearsal.dot_noise import DrawnPicture, drawn_pictures, measured_noise
from labcal.guide.rehearsal.forecast import forecast
from labcal.guide.rehearsal.planned_rig import PlannedRig
from labcal.guide.rehearsal.rig_plan import RigPlan
from labcal.guide.rehearsal.sources import Sources
from labcal.targets.grid import DotGrid

SCALES = (0.5, 0.71, 1.0, 1.41, 2.0)
COUNTS = (4, 6, 9, 12, 18, 24, 36, 48)
LITTLE = 0.1
"""Share of the error that twice as many views should bring to be worth it."""
_DRAWN = 4
"""Views that are drawn of each board."""


@dataclass(frozen=True)
class BoardFit:
    """A board in the planned rig.

    Attributes
    ----------
    scale : float
        Of the planned target.
    width_mm, height_mm : float
        Of the board.
    dot_px : float
        Median minor semi-axis of its dots in the pictures; NaN where nothing is seen.
    coverage : float
        Share of the picture that the board's dots span in the median view.
    found : float
        Share of the dots that the detector measures in drawn pictures.
    rms_mm : float
        RMS 3-D error after a calibration with it; NaN where it does not fit.
    why_not : str
        Why it does not fit; empty where it does.
    """

    scale: float
    width_mm: float
    height_mm: float
    dot_px: float
    coverage: float
    found: float
    rms_mm: float
    why_not: str = ""


@dataclass(frozen=True)
class ViewCount:
    """A number of views, and the RMS 3-D error after a calibration from them; NaN where that is none."""

    views: int
    rms_mm: float


def scaled(target: DotGrid, scale: float) -> DotGrid:
    """Return a target that is printed larger or smaller."""
    content = target.model_dump()
    for key, value in content.items():
        if key.endswith("_mm") and isinstance(value, float):
            content[key] = scale * value
    return DotGrid.model_validate(content)


def board_fits(plan: RigPlan, sources: Sources, seed: int) -> tuple[BoardFit, ...]:
    """Return the planned board in several sizes; points are measured with the same noise after each.

    Parameters
    ----------
    plan : RigPlan
    sources : Sources
        Their points keep their noise.
    seed : int
    """
    return tuple(_board_fit(plan, scale, sources, seed) for scale in SCALES)


def view_counts(
    planned: PlannedRig, views: list[Pose], further: list[Pose], sources: Sources
) -> tuple[ViewCount, ...]:
    """Return the error for several numbers of views, the planned one among them.

    Fewer views are the first ones of the plan, since these cover most; more are the plan's and further ones.

    Parameters
    ----------
    planned : PlannedRig
    views, further : list of ndarray, shape (4, 4)
        Planned poses, and those to take then.
    sources : Sources
    """
    every = [*views, *further]
    counts = sorted({*COUNTS, len(views), 2 * len(views)})
    return tuple(
        ViewCount(count, rms_or_nan(planned, every[:count], sources))
        for count in counts
        if count <= len(every)
    )


def enough_views(counts: tuple[ViewCount, ...]) -> int | None:
    """Return the least number from which on twice as many bring less than a tenth; None if none does."""
    known = {one.views: one.rms_mm for one in counts if np.isfinite(one.rms_mm)}
    enough = None
    for views, rms_mm in sorted(known.items(), reverse=True):
        more = [other for other in sorted(known) if other >= 2 * views]
        if not more:
            continue
        if known[more[0]] < (1.0 - LITTLE) * rms_mm:
            break
        enough = views
    return enough


def coverage_of(pictures: list[DrawnPicture]) -> float:
    """Return the median share of the picture that dots span."""
    return float(np.median([picture.spanned for picture in pictures]))


def rms_or_nan(planned: PlannedRig, views: list[Pose], sources: Sources) -> float:
    """Return the RMS 3-D error to expect, mm; NaN where the views do not determine the cameras."""
    try:
        return forecast(planned, views, sources).rms_mm
    except InputError:
        return float("nan")


def _board_fit(plan: RigPlan, scale: float, sources: Sources, seed: int) -> BoardFit:
    target = scaled(plan.target, scale)
    x_min, y_min, x_max, y_max = target.extent_mm
    size = (x_max - x_min, y_max - y_min)
    planned = PlannedRig.of(plan.model_copy(update={"target": target}))
    pictures: list[DrawnPicture] = []
    try:
        views: list[Pose] = planned.views(plan.shoot.views, seed)
        some = views[:: -(-len(views) // _DRAWN)]
        pictures = drawn_pictures(planned.cameras, some, target, plan.photometry, seed)
        dots = sources.dots if scale == 1.0 else measured_noise(pictures)
        rms_mm, why_not = forecast(planned, views, replace(sources, dots=dots)).rms_mm, ""
    except InputError as error:
        rms_mm, why_not = float("nan"), str(error)
    if not pictures:
        nan = float("nan")
        return BoardFit(scale, *size, nan, nan, nan, rms_mm, why_not)
    return BoardFit(
        scale,
        *size,
        dot_px=float(np.median([picture.dot_px for picture in pictures])),
        coverage=coverage_of(pictures),
        found=sum(one.found for one in pictures) / max(1, sum(one.whole for one in pictures)),
        rms_mm=rms_mm,
        why_not=why_not,
    )
