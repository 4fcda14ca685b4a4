"""Motion of the target while the pictures of a set are taken, from a second set right after it."""

import numpy as np

from labcal.capture.source import Frame, FrameSet
from labcal.detect.detector import detect_dots
from labcal.detect.dots import PictureDots
from labcal.targets.catalogue import AnyTarget

MOST_PX = 0.1
"""A set in which the target moved by more is refused: the dots of a picture would all be off by as much."""
_LEAST_DOTS = 4


def motion_px(first: FrameSet, second: FrameSet, target: AnyTarget) -> dict[str, float]:
    """Return how far the target's image moved in each picture of a set while the set was taken.

    Two sets, one right after the other, tell how fast the image of the target moves. It moves at that speed
    for as long as the picture was exposed, and as long as it was taken after the first one of its set.

    Parameters
    ----------
    first : FrameSet
        The set that is judged.
    second : FrameSet
        The one taken next.
    target : AnyTarget

    Returns
    -------
    dict of str to float
        px by camera. A camera is left out where times are not known, or the target is not found in both.
    """
    begun = [frame.time_s for frame in first.frames.values() if frame.time_s is not None]
    moved = {}
    for name, frame in first.frames.items():
        after = second.frames.get(name)
        if after is None or frame.time_s is None or after.time_s is None or after.time_s <= frame.time_s:
            continue
        step = image_step_px(frame, after, target)
        if step is not None:
            lasted = frame.time_s - min(begun) + 1e-6 * (frame.exposure_us or 0.0)
            moved[name] = step * lasted / (after.time_s - frame.time_s)
    return moved


def image_step_px(frame: Frame, after: Frame, target: AnyTarget) -> float | None:
    """Return the median distance of the same dots between two pictures, px; None where there are too few."""
    before, later = (detect_dots(one.picture, target) for one in (frame, after))
    if not (before.indexed and later.indexed):
        return None
    ids = _by_id(later)
    steps = [
        float(np.hypot(*(ids[dot] - position))) for dot, position in _by_id(before).items() if dot in ids
    ]
    return float(np.median(steps)) if len(steps) >= _LEAST_DOTS else None


def _by_id(dots: PictureDots) -> dict[tuple[int, int], np.ndarray]:
    """Return measured positions (px) by column and row."""
    measured = dots.has_id & np.isfinite(dots.position).all(axis=1)
    return {
        (int(col), int(row)): position
        for (col, row), position in zip(dots.index[measured], dots.position[measured], strict=True)
    }
