"""Reasons why no grid of dots is found: what was seen instead, and dots that are too small."""

import cv2
import numpy as np
from jaxtyping import Float32

from labcal.detect.flags import Refusal
from labcal.detect.grey import GreyPicture
from labcal.detect.grid import find_grid
from labcal.detect.lattice.marks_beside import lines_seen
from labcal.detect.medians import DEVIATIONS_A_MAD
from labcal.detect.segmentation import Candidates, segmentations
from labcal.detect.settings import DetectSettings
from labcal.targets.grid import DotGrid
from labcal.wording import counted

_LINES_TELL = (Refusal.AMBIGUOUS, Refusal.AMBIGUOUS_RINGS, Refusal.NO_RINGS, Refusal.MIRRORED)
_MAY_BE_SMALL = (Refusal.NO_DOTS, Refusal.TOO_FEW_DOTS, Refusal.NO_GRID)
_LEAST_HOLE_PX = 2.5
"""Width of the hole of a ring, below which it may look like a dot."""
_ENLARGED = 3
_SPECK_PX = 7
"""Side of the window in which a speck is darker than what surrounds it."""
_MOST_PIXELS = 400_000
"""Of the part of a picture that is enlarged."""
_AROUND_PX = 8
_SPECK_SIGMAS = 6.0


def why_no_grid(
    refusal: Refusal, grey: GreyPicture, candidates: Candidates, target: DotGrid, settings: DetectSettings
) -> tuple[Refusal, str]:
    """Return why a picture shows no grid that can be numbered, and a sentence on what it shows.

    Parameters
    ----------
    refusal : Refusal
        As the stages of detection give it.
    grey : ndarray, shape (h, w)
        The picture, dots dark.
    candidates : Candidates
        The spots in it.
    target : DotGrid
    settings : DetectSettings
    """
    if refusal in _LINES_TELL:
        words = lines_seen(candidates.whole, target, settings.grid)
        hole = _hole_px(candidates, target)
        if refusal is Refusal.NO_RINGS and hole < _LEAST_HOLE_PX:
            return Refusal.TOO_SMALL, f"{words} The holes of its rings are some {hole:.1f} px wide."
        return refusal, words
    if refusal not in _MAY_BE_SMALL:
        return refusal, ""
    small = _small_dots(grey, target, settings)
    if small is not None:
        return Refusal.TOO_SMALL, f"A grid of dots some {small:.1f} px across was seen."
    return refusal, _spots_words(refusal, candidates, settings.grid.min_dots)


def _hole_px(candidates: Candidates, target: DotGrid) -> float:
    """Return the usual width of a ring's hole, by the size of the spots, px."""
    radius = candidates.whole.radius
    return 2.0 * target.hole_share * float(np.median(radius)) if len(radius) else float("inf")


def _spots_words(refusal: Refusal, candidates: Candidates, least: int) -> str:
    """Return how many spots were seen; nothing where there are none."""
    whole, cut = len(candidates.whole.centre), len(candidates.cut.centre)
    if whole + cut == 0:
        return ""
    words = f"{counted(whole, 'round spot')} {'was' if whole == 1 else 'were'} seen whole"
    words += f", {cut} cut by the frame" if cut else ""
    return f"{words}; a grid takes {least}." if refusal is not Refusal.NO_GRID else f"{words}."


def _small_dots(grey: GreyPicture, target: DotGrid, settings: DetectSettings) -> float | None:
    """Return the diameter of dots of the target's grid that are found in an enlarged picture only, px."""
    part = _with_specks(grey, settings.grid.min_dots)
    if part is None:
        return None
    large = cv2.resize(part, None, fx=_ENLARGED, fy=_ENLARGED, interpolation=cv2.INTER_CUBIC)
    diameter = _diameter(np.ascontiguousarray(large, dtype=np.float32), target, settings)
    return None if diameter is None else diameter / _ENLARGED


def _diameter(grey: GreyPicture, target: DotGrid, settings: DetectSettings) -> float | None:
    """Return the usual diameter of the dots of the target's grid in a picture, px; None where it has none."""
    for candidates in segmentations(grey, target, settings.segmentation):
        grid = find_grid(candidates.whole, target, (grey.shape[1], grey.shape[0]), settings.grid)
        if not isinstance(grid, Refusal):
            return 2.0 * float(np.median(candidates.whole.radius[grid.spots]))
    return None


def _with_specks(grey: GreyPicture, least: int) -> Float32[np.ndarray, "rows cols"] | None:
    """Return the part of a picture with small dark specks in it; None where they are few, or all over it."""
    if min(grey.shape) < _SPECK_PX:
        return None
    window = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (_SPECK_PX, _SPECK_PX))
    depth = cv2.morphologyEx(grey, cv2.MORPH_BLACKHAT, window)
    usual = float(np.median(depth))
    scatter = DEVIATIONS_A_MAD * float(np.median(np.abs(depth - usual)))
    dark = (depth > max(usual + _SPECK_SIGMAS * scatter, 0.25 * float(depth.max()))).astype(np.uint8)
    count, _, stats, _ = cv2.connectedComponentsWithStats(dark)
    if count - 1 < least or not depth.max() > 0.0:
        return None
    left, top = stats[1:, cv2.CC_STAT_LEFT], stats[1:, cv2.CC_STAT_TOP]
    right, bottom = left + stats[1:, cv2.CC_STAT_WIDTH], top + stats[1:, cv2.CC_STAT_HEIGHT]
    low = np.maximum(np.array([left.min(), top.min()]) - _AROUND_PX, 0)
    high = np.array([right.max(), bottom.max()]) + _AROUND_PX
    part = grey[low[1] : high[1], low[0] : high[0]]
    return part if part.size <= _MOST_PIXELS else None
