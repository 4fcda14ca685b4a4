"""Looking for a target's grid in a picture, level by level, through one lens after the other."""

from dataclasses import dataclass

import numpy as np

from labcal.detect.blobs import Blobs, blobs_of, joined, pyramid
from labcal.detect.flags import Refusal
from labcal.detect.flattening import NONE, Flattening, fisheyes
from labcal.detect.grey import GreyPicture, clipping, is_flat
from labcal.detect.lattice import Lattice, find_lattices
from labcal.detect.numbering import AnyNumbering, number_lattice, why_unnamed
from labcal.detect.outlines import Outlines, inside_frame, trace_outlines
from labcal.detect.shapes import without_odd
from labcal.detect.smoothness import is_smooth
from labcal.geometry.two_by_two import eigenvalues
from labcal.targets.grid import DotGrid

_FEWEST_DOTS = 9  # a cross, its corners: less is no grid
_COARSE = 700  # px: the longer side of the level where the search begins
_TOO_LARGE = 12.0  # px of a level: larger ones are looked for in coarser levels as well
_RESOLVED = 3.5  # px of a level: it misses no dot whose neighbours' minor axes are all larger
_MARGIN = 0.5  # px beyond the outermost pixel centres: the frame
_COMPLETE = 0.97  # of the spots that are as large as dots
_CLIPPED_PICTURE = 0.5
_SOFT, _SOFT_PX = 0.2, 1.5  # of the minor axis, and px: rings lose their holes
_CAUSED = (Refusal.NO_DOTS, Refusal.TOO_FEW_DOTS, Refusal.NO_GRID, Refusal.NO_RINGS)


@dataclass(frozen=True)
class Seen:
    """What a look at a picture gave."""

    blobs: Blobs
    whole: Outlines
    """Outlines in the frame, to which the lattice refers."""
    cut: Outlines
    """Outlines that reach beyond it."""
    grid: tuple[Lattice, AnyNumbering] | Refusal


def search(grey: GreyPicture, target: DotGrid) -> Seen:
    """Look for the grid from a coarse level of the picture on, and in finer ones until nothing is missed."""
    levels = [] if is_flat(grey) else pyramid(grey)  # however large: there is nothing to look at
    start = next((k for k, level in enumerate(levels) if max(level.grey.shape) <= _COARSE), 0)
    looks = [slice(start, start + 1), *(slice(finest, None) for finest in range(start, -1, -1))]
    blobs: dict[int, Blobs] = {}
    if not levels:
        return _seen(grey, joined([]), target)
    for look in looks:
        for number, level in enumerate(levels[look], start=look.start):
            if number not in blobs:
                blobs[number] = blobs_of(level)
        seen = _seen(grey, joined([blobs[number] for number in sorted(blobs)]), target)
        largest = levels[start].scale * _TOO_LARGE if look.stop else np.inf
        if not isinstance(seen.grid, Refusal):
            shape = seen.whole.shape[list(seen.grid[0].spots.values())]
            minor, major = np.sqrt(eigenvalues(shape)).T
            if minor.min() >= _RESOLVED * levels[look.start].scale and major.max() <= largest:
                break
    return seen


def _seen(grey: GreyPicture, blobs: Blobs, target: DotGrid) -> Seen:
    """Return what the blobs of some levels are."""
    size = (grey.shape[1], grey.shape[0])
    outlines = trace_outlines(grey, blobs, target)
    inside = inside_frame(outlines.centre, outlines.shape, size, _MARGIN)
    whole = outlines.select(inside)
    return Seen(blobs, whole, outlines.select(~inside), _find_grid(whole, target, size))


def cause(refusal: Refusal, grey: GreyPicture, outlines: Outlines) -> Refusal:
    """Return what is behind there being no dots or no grid, where the picture tells."""
    if refusal not in _CAUSED:
        return refusal
    low, high = clipping(grey)
    clipped = np.count_nonzero(grey <= low) + np.count_nonzero(grey >= high)
    if low < high and clipped > _CLIPPED_PICTURE * grey.size:
        return Refusal.SATURATED
    minor = np.sqrt(eigenvalues(outlines.shape)[:, 0])
    blur = outlines.blur
    blurred = len(minor) >= _FEWEST_DOTS and np.median(blur / minor) > _SOFT and np.median(blur) > _SOFT_PX
    return Refusal.BLURRED if blurred else refusal


def _find_grid(
    outlines: Outlines, target: DotGrid, size: tuple[int, int]
) -> tuple[Lattice, AnyNumbering] | Refusal:
    """Return the lattice that can be numbered, with the lens that shows most of it."""
    best = _choose(outlines, target, NONE)
    if len(outlines.centre) < _FEWEST_DOTS or _is_complete(best, outlines):
        return best
    for lens in fisheyes(size):
        other = _choose(outlines, target, lens)
        if not isinstance(other, Refusal) and (isinstance(best, Refusal) or len(other[0]) > len(best[0])):
            best = other
            if _is_complete(best, outlines):
                break
    return best


def _is_complete(grid: tuple[Lattice, AnyNumbering] | Refusal, outlines: Outlines) -> bool:
    """Tell whether a grid holds nearly every spot that is as large as its dots."""
    if isinstance(grid, Refusal):
        return False
    radius = outlines.radius
    known = radius[list(grid[0].spots.values())]
    alike = (radius > 0.8 * known.min()) & (radius < 1.2 * known.max())
    return len(known) >= _COMPLETE * int(alike.sum())


def _choose(outlines: Outlines, target: DotGrid, lens: Flattening) -> tuple[Lattice, AnyNumbering] | Refusal:
    """Return the one lattice that can be numbered in the picture of a lens."""
    if len(outlines.centre) == 0:
        return Refusal.NO_DOTS
    if len(outlines.centre) < _FEWEST_DOTS:
        return Refusal.TOO_FEW_DOTS
    lattices = [without_odd(lattice, outlines, target) for lattice in find_lattices(outlines, target, lens)]
    outlines = lens.outlines(outlines)
    if not lattices:
        return Refusal.NO_GRID
    outcomes = [(lattice, number_lattice(lattice, outlines, target)) for lattice in lattices]
    named = [(lattice, outcome) for lattice, outcome in outcomes if not isinstance(outcome, Refusal)]
    refusal = why_unnamed([outcome for _, outcome in outcomes], target)
    if refusal is not None:
        return refusal
    return named[0] if is_smooth(named[0][0], outlines.centre) else Refusal.GRID_INCONSISTENT
