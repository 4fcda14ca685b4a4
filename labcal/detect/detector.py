"""From a picture to its dots: the stages of detection in order."""

from collections import Counter
from dataclasses import dataclass, replace

import numpy as np

from labcal.detect.blobs import Blobs, blobs_of, joined, pyramid
from labcal.detect.charuco import detect_charuco
from labcal.detect.dots import PictureDots
from labcal.detect.edge_fit import fit_edges
from labcal.detect.flags import DotFlag, Refusal
from labcal.detect.flattening import NONE, Flattening, fisheyes
from labcal.detect.grey import AnyPicture, GreyPicture, clipping, grey_picture
from labcal.detect.lattice import Lattice, find_lattices
from labcal.detect.lost import lost_dots
from labcal.detect.numbering import AnyNumbering, number_lattice, why_unnamed
from labcal.detect.outlines import Outlines, clear_reach, trace_outlines
from labcal.detect.plain import goes_on, with_lookalikes
from labcal.detect.probe import with_missed
from labcal.detect.shapes import odd_shapes, without_odd
from labcal.detect.smoothness import is_smooth
from labcal.targets.catalogue import AnyTarget
from labcal.targets.charuco import CharucoBoard
from labcal.targets.grid import DotGrid, Polarity

_FEWEST_DOTS = 9  # a cross, its corners: less is no grid
# An outline further from its ellipse is not measured: times the usual departure of the picture's dots (a
# print may be ragged, a renderer's discs are polygons), and of the radius.
_DEPARTURE = (2.5, 0.012)
_COARSE = 700  # px: the longer side of the level where the search begins
_TOO_LARGE = 12.0  # px of a level: larger ones are looked for in coarser levels as well
_RESOLVED = 3.5  # px of a level: it misses no dot whose neighbours' minor axes are all larger
_MARGIN = 0.5  # px beyond the outermost pixel centres: the frame
_BLURRED = 0.6  # of the minor axis
_CLIPPED = 0.06
_COMPLETE = 0.97  # of the spots that are as large as dots
_CLIPPED_PICTURE = 0.5
_SOFT, _SOFT_PX = 0.2, 1.5  # of the minor axis, and px: rings lose their holes
_CAUSED = (Refusal.NO_DOTS, Refusal.TOO_FEW_DOTS, Refusal.NO_GRID, Refusal.NO_RINGS)
_ALIKE = 0.5  # in the logarithm of the radius


@dataclass(frozen=True)
class _Dot:
    """One dot on its way into `PictureDots`."""

    index: tuple[int, int] | None
    flag: DotFlag
    seen_at: np.ndarray
    outline: np.ndarray
    centre: np.ndarray | None = None
    covariance: np.ndarray | None = None


def detect_dots(image: AnyPicture, target: AnyTarget) -> PictureDots:
    """Find the target's dots, or the corners of a ChArUco board, in one picture.

    The target's polarity is tried first. Where that gives no ids the other one is tried, and taken only if it
    does.

    Parameters
    ----------
    image : ndarray, shape (h, w), (h, w, 3) or (h, w, 4)
        uint8, uint16 or float; colour in any order.
    target : AnyTarget
        What to look for.

    Returns
    -------
    PictureDots
        With a `refusal` where the picture has no ids: a picture is never given doubtful ones.

    Raises
    ------
    InputTypeError, InputError
        `image` is no picture (see :func:`labcal.detect.grey.grey_picture`).
    """
    grey = grey_picture(image)
    if isinstance(target, CharucoBoard):
        return detect_charuco(grey, target)
    if np.shares_memory(grey, image):
        grey = grey.copy()  # it is turned into its negative in place, since it may be large
    if target.polarity is Polarity.WHITE_ON_BLACK:
        _invert(grey)
    first = _detect(grey, target, target.polarity)
    if first.indexed:
        return first
    _invert(grey)
    other = Polarity.WHITE_ON_BLACK if target.polarity is Polarity.BLACK_ON_WHITE else Polarity.BLACK_ON_WHITE
    second = _detect(grey, target, other)
    return second if second.indexed else first


def _invert(grey: GreyPicture) -> None:
    """Turn a picture into its negative, in place."""
    if grey.size:
        np.subtract(grey.max(), grey, out=grey)


def _detect(grey: GreyPicture, target: DotGrid, polarity: Polarity) -> PictureDots:
    """Detect dots of one polarity, which are dark in `grey`."""
    size = (grey.shape[1], grey.shape[0])
    seen = _search(grey, target)
    if isinstance(seen.grid, Refusal):
        refusal = _cause(seen.grid, grey, seen.whole)
        return _collect(_unnamed(seen.whole.joined(seen.cut), set()), size, polarity, refusal)
    lattice, numbering = seen.grid
    lattice, outlines = with_missed(grey, lattice, numbering, seen.whole, target)
    lost = lost_dots(lattice, outlines, seen.blobs, size, lambda node: target.holds(*numbering.index(node)))
    if target.rings is None and goes_on(lost, numbering, target):
        return _collect(_unnamed(seen.whole.joined(seen.cut), set()), size, polarity, Refusal.AMBIGUOUS)
    dots = _measured(grey, lattice, numbering, outlines, target)
    dots += [_Dot(numbering.index(dot.node), dot.flag, dot.seen_at, dot.outline) for dot in lost]
    named = set(lattice.spots.values())
    typical = float(np.median(outlines.radius[sorted(named)]))
    dots += [dot for dot in _unnamed(outlines.joined(seen.cut), named) if _alike(dot, typical)]
    return with_lookalikes(_collect(_one_an_id(dots), size, polarity, None), target)


@dataclass(frozen=True)
class _Seen:
    """What a look at a picture gave."""

    blobs: Blobs
    whole: Outlines
    """Outlines in the frame, to which the lattice refers."""
    cut: Outlines
    """Outlines that reach beyond it."""
    grid: tuple[Lattice, AnyNumbering] | Refusal


def _search(grey: GreyPicture, target: DotGrid) -> _Seen:
    """Look for the grid from a coarse level of the picture on, and in finer ones until nothing is missed."""
    levels = pyramid(grey)
    start = next((k for k, level in enumerate(levels) if max(level.picture.shape) <= _COARSE), 0)
    looks = [slice(start, start + 1), *(slice(finest, None) for finest in range(start, -1, -1))]
    blobs: dict[int, Blobs] = {}
    seen = _seen(grey, joined([]), target)
    for look in looks if levels else []:
        for number, level in enumerate(levels[look], start=look.start):
            if number not in blobs:
                blobs[number] = blobs_of(level)
        seen = _seen(grey, joined([blobs[number] for number in sorted(blobs)]), target)
        largest = levels[start].scale * _TOO_LARGE if look.stop else np.inf
        if not isinstance(seen.grid, Refusal):
            shape = seen.whole.shape[list(seen.grid[0].spots.values())]
            minor, major = np.sqrt(np.linalg.eigvalsh(shape)).T
            if minor.min() >= _RESOLVED * levels[look.start].scale and major.max() <= largest:
                break
    return seen


def _seen(grey: GreyPicture, blobs: Blobs, target: DotGrid) -> _Seen:
    """Return what the blobs of some levels are."""
    size = (grey.shape[1], grey.shape[0])
    outlines = trace_outlines(grey, blobs, target)
    inside = _inside_frame(outlines, size)
    whole = outlines.select(inside)
    return _Seen(blobs, whole, outlines.select(~inside), _find_grid(whole, target, size))


def _cause(refusal: Refusal, grey: GreyPicture, outlines: Outlines) -> Refusal:
    """Return what is behind there being no dots or no grid, where the picture tells."""
    if refusal not in _CAUSED:
        return refusal
    low, high = clipping(grey)
    clipped = np.count_nonzero(grey <= low) + np.count_nonzero(grey >= high)
    if low < high and clipped > _CLIPPED_PICTURE * grey.size:
        return Refusal.SATURATED
    minor = np.sqrt(np.linalg.eigvalsh(outlines.shape)[:, 0])
    blur = outlines.blur
    blurred = len(minor) >= _FEWEST_DOTS and np.median(blur / minor) > _SOFT and np.median(blur) > _SOFT_PX
    return Refusal.BLURRED if blurred else refusal


def _inside_frame(outlines: Outlines, size: tuple[int, int]) -> np.ndarray:
    """Tell which outlines lie in the frame as a whole."""
    extent = np.sqrt(np.diagonal(outlines.shape, axis1=1, axis2=2))
    low, high = outlines.centre - extent, outlines.centre + extent
    inside: np.ndarray = ((low > -_MARGIN) & (high < np.array(size) - 1 + _MARGIN)).all(axis=1)
    return inside


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


def _measured(
    grey: GreyPicture, lattice: Lattice, numbering: AnyNumbering, outlines: Outlines, target: DotGrid
) -> list[_Dot]:
    """Return the dots of the lattice, fitted."""
    hole = target.hole_share
    named = [(numbering.index(node), spot) for node, spot in lattice.spots.items()]
    spots = outlines.select(np.array([spot for _, spot in named]))
    holes = np.array([hole if index in target.ring_indices else 0.0 for index, _ in named])
    fits = fit_edges(grey, spots, holes, clear_reach(target))
    usual = float(np.median(fits.departure[fits.ok])) if fits.ok.any() else 0.0
    rough = fits.departure > _DEPARTURE[0] * usual + _DEPARTURE[1] * spots.radius
    shape = outlines.shape.copy()
    shape[list(lattice.spots.values())] = np.where(fits.ok[:, None, None], fits.shape, spots.shape)
    rough |= odd_shapes(lattice, replace(outlines, shape=shape), target)
    minor = np.sqrt(np.linalg.eigvalsh(spots.shape)[:, 0])
    dots = []
    for number, (index, _) in enumerate(named):
        seen_at, outline = spots.centre[number], spots.shape[number]
        if spots.blur[number] > _BLURRED * minor[number]:
            dots.append(_Dot(index, DotFlag.BLURRED, seen_at, outline))
        elif fits.ok[number] and fits.clipped[number] > _CLIPPED:
            dots.append(_Dot(index, DotFlag.SATURATED, seen_at, outline))
        elif not fits.ok[number] or rough[number]:
            dots.append(_Dot(index, DotFlag.BAD_FIT, seen_at, outline))
        else:
            flag = DotFlag.OK if target.holds(*index) else DotFlag.BEYOND_GRID
            centre = fits.centre[number]
            dots.append(_Dot(index, flag, centre, fits.shape[number], centre, fits.covariance[number]))
    return dots


def _unnamed(outlines: Outlines, named: set[int]) -> list[_Dot]:
    """Return the spots that have no place in the grid."""
    return [
        _Dot(None, DotFlag.NO_ID, outlines.centre[spot], outlines.shape[spot])
        for spot in range(len(outlines.centre))
        if spot not in named
    ]


def _alike(dot: _Dot, radius: float) -> bool:
    """Tell whether a spot is about as large as the dots, so that a person might take it for one."""
    return bool(abs(np.log(np.linalg.det(dot.outline) ** 0.25 / radius)) < _ALIKE)


def _one_an_id(dots: list[_Dot]) -> list[_Dot]:
    """Return the dots with every id at most once; of two, neither can be trusted."""
    count = Counter(dot.index for dot in dots if dot.index is not None)
    return [
        dot if dot.index is None or count[dot.index] == 1 else replace(dot, index=None, flag=DotFlag.NO_ID)
        for dot in dots
    ]


def _collect(
    dots: list[_Dot], size: tuple[int, int], polarity: Polarity, refusal: Refusal | None
) -> PictureDots:
    """Sort the dots and put them into arrays."""
    dots = sorted(
        dots,
        key=lambda dot: (
            dot.index is None,
            *(dot.index or (0, 0))[::-1],
            float(dot.seen_at[1]),
            float(dot.seen_at[0]),
        ),
    )
    missing = np.full((2, 2), np.nan)
    return PictureDots(
        size=size,
        polarity=polarity,
        refusal=refusal,
        index=np.array([dot.index or (0, 0) for dot in dots], dtype=np.int64).reshape(-1, 2),
        has_id=np.array([dot.index is not None for dot in dots], dtype=bool),
        position=np.array([missing[0] if dot.centre is None else dot.centre for dot in dots], float).reshape(
            -1, 2
        ),
        covariance=np.array(
            [missing if dot.covariance is None else dot.covariance for dot in dots], float
        ).reshape(-1, 2, 2),
        flag=tuple(dot.flag for dot in dots),
        seen_at=np.array([dot.seen_at for dot in dots], float).reshape(-1, 2),
        outline=np.array([dot.outline for dot in dots], float).reshape(-1, 2, 2),
    )
