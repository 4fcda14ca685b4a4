"""The verdict on the detection of one picture, by comparison with the truth."""

from dataclasses import dataclass

import numpy as np

from labcal.bench.detect.dot_visibility import DotVisibility
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag

MEASURED_OFF_PX = 3.0
"""Error above which the id of a measured dot counts as wrong."""
MISLED_PX, MISLED_SIGMAS = 0.2, 4.0
"""Error above which (both) a measured dot is misled by something that covers or touches it."""
LEAST_SEEN = 0.5
"""Visible share below which a dot counts as absent."""


@dataclass(frozen=True)
class Verdict:
    """The verdict on one picture."""

    indexed: bool
    refusal: str | None
    measurable: int
    found: int
    """Measurable dots that are ``ok``, under their own ids."""
    wrong_ids: int
    """Measured dots whose id belongs to a dot elsewhere."""
    astray: int
    """Flagged, not measured dots that are drawn elsewhere than the dot with their id."""
    false_dots: int
    """Measured dots where no dot is, or at most a part of one."""
    measured: int
    """Dots measured, measurable or not."""
    misled: int
    """The number of these whose error exceeds their uncertainty, with correct ids."""
    worst_px: float
    """Greatest error of the measurable dots found, px; NaN for none."""


def verdict_of(dots: PictureDots, seen: DotVisibility, cols: int) -> Verdict:
    """Return the verdict on the detection of one picture.

    An id is wrong where a measured dot is further than half a pitch, or :data:`MEASURED_OFF_PX`, from the
    true dot of that id. Where a dot that is not measured is drawn does no harm, but is counted too: what the
    frame cuts is seen off its middle, and what is hidden where it is thought to be. A dot is false where it
    was measured, and no dot of which half can be seen is within half a pitch.

    Parameters
    ----------
    dots : PictureDots
    seen : DotVisibility
    cols : int
        Columns of the target.
    """
    measured = np.array([flag in {DotFlag.OK, DotFlag.BEYOND_GRID} for flag in dots.flag], dtype=bool)
    place = np.where(measured[:, None], dots.position, dots.seen_at)
    number = dots.index[:, 1] * cols + dots.index[:, 0]
    declared = ((dots.index >= 0) & (dots.index < [cols, len(seen.index) // cols])).all(axis=1)
    own = np.where(declared, number, 0)
    off = np.linalg.norm(place - seen.centroid[own], axis=1)
    bound = 0.5 * seen.pitch_px[own]
    bound[measured] = np.minimum(bound[measured], MEASURED_OFF_PX)
    right = dots.has_id & declared & (off <= bound)
    wrong = dots.has_id & ~right
    found = right & dots.ok & seen.measurable[own]
    sigma = np.sqrt(np.trace(dots.covariance, axis1=1, axis2=2))
    return Verdict(
        indexed=dots.indexed,
        refusal=None if dots.refusal is None else str(dots.refusal),
        measurable=int(seen.measurable.sum()),
        found=int(found.sum()),
        wrong_ids=int((wrong & measured).sum()),
        astray=int((wrong & ~measured & declared).sum()),
        false_dots=sum(_is_false(place[i], seen) for i in np.flatnonzero(measured)),
        measured=int(measured.sum()),
        misled=int((right & measured & (off > np.maximum(MISLED_PX, MISLED_SIGMAS * sigma))).sum()),
        worst_px=float(off[found].max()) if found.any() else float("nan"),
    )


def _is_false(place: np.ndarray, seen: DotVisibility) -> bool:
    """Tell whether there is no dot, or less than half of one, at a place."""
    away = np.linalg.norm(seen.centroid - place, axis=1)
    nearest = int(np.nanargmin(away))
    return bool(away[nearest] > 0.5 * seen.pitch_px[nearest] or seen.hidden[nearest] > LEAST_SEEN)
