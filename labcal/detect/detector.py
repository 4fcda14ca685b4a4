"""From a picture to its dots: the stages of detection in order."""

from collections import Counter
from dataclasses import dataclass, replace

import numpy as np

from labcal.detect.blobs import Blobs, blobs_of, joined, pyramid
from labcal.detect.dots import PictureDots
from labcal.detect.edge_fit import EdgeFits, fit_edges
from labcal.detect.flags import DotFlag, Refusal
from labcal.detect.grey import AnyPicture, GreyPicture, grey_picture
from labcal.detect.lattice import Lattice, find_lattices
from labcal.detect.lost import lost_dots
from labcal.detect.outlines import Outlines, clear_reach, trace_outlines
from labcal.detect.probe import with_missed
from labcal.detect.rings import Numbering, number_lattice
from labcal.detect.smoothness import is_smooth
from labcal.targets.grid import DotGrid, Polarity

_FEWEST_DOTS = 9  # a cross, its corners: less is no grid
# An outline further from its ellipse is not measured: times the usual departure of the picture's dots (a
# print may be ragged, a renderer's discs are polygons), and of the radius.
_DEPARTURE = (2.5, 0.012)
_COARSE = 700  # px: the longer side of the level where the search begins
_RESOLVED = 3.5  # px of a level: it misses no dot whose neighbours' minor axes are all larger
_MARGIN = 0.5  # px beyond the outermost pixel centres: the frame
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


def detect_dots(image: AnyPicture, target: DotGrid) -> PictureDots:
    """Find the target's dots in one picture.

    The target's polarity is tried first. Where that gives no ids the other one is tried, and taken only if it
    does.

    Parameters
    ----------
    image : ndarray, shape (h, w), (h, w, 3) or (h, w, 4)
        uint8, uint16 or float; colour in any order.
    target : DotGrid
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
    other = Polarity.WHITE_ON_BLACK if target.polarity is Polarity.BLACK_ON_WHITE else Polarity.BLACK_ON_WHITE
    first = _detect(grey, target, target.polarity)
    if first.indexed:
        return first
    second = _detect(grey, target, other)
    return second if second.indexed else first


def _detect(grey: GreyPicture, target: DotGrid, polarity: Polarity) -> PictureDots:
    """Detect dots of one polarity."""
    size = (grey.shape[1], grey.shape[0])
    if polarity is Polarity.WHITE_ON_BLACK and grey.size:
        grey = grey.max() - grey
    seen = _search(grey, target)
    if isinstance(seen.grid, Refusal):
        return _collect(_unnamed(seen.whole.joined(seen.cut), set()), size, polarity, seen.grid)
    lattice, numbering = seen.grid
    lattice, outlines = with_missed(grey, lattice, numbering, seen.whole, target)
    dots = _measured(grey, lattice, numbering, outlines, target)
    dots += [
        _Dot(numbering.index(lost.node), lost.flag, lost.seen_at, lost.outline)
        for lost in lost_dots(lattice, outlines, seen.blobs, size)
    ]
    named = set(lattice.spots.values())
    typical = float(np.median(outlines.radius[sorted(named)]))
    dots += [dot for dot in _unnamed(outlines.joined(seen.cut), named) if _alike(dot, typical)]
    return _collect(_one_an_id(dots), size, polarity, None)


@dataclass(frozen=True)
class _Seen:
    """What a look at a picture gave."""

    blobs: Blobs
    whole: Outlines
    """Outlines in the frame, to which the lattice refers."""
    cut: Outlines
    """Outlines that reach beyond it."""
    grid: tuple[Lattice, Numbering] | Refusal


def _search(grey: GreyPicture, target: DotGrid) -> _Seen:
    """Look for the grid from a coarse level of the picture on, and in finer ones until nothing is missed."""
    levels = pyramid(grey)
    finest = next((k for k, level in enumerate(levels) if max(level.picture.shape) <= _COARSE), 0)
    found = [blobs_of(level) for level in levels[finest:]]
    while True:
        blobs = joined(found)
        outlines = trace_outlines(grey, blobs, target)
        inside = _inside_frame(outlines, (grey.shape[1], grey.shape[0]))
        whole = outlines.select(inside)
        seen = _Seen(
            blobs, whole, outlines.select(~inside), _choose(find_lattices(whole, target), whole, target)
        )
        if finest == 0:
            return seen
        if not isinstance(seen.grid, Refusal):
            shape = whole.shape[list(seen.grid[0].spots.values())]
            if np.linalg.eigvalsh(shape)[:, 0].min() >= (_RESOLVED * levels[finest].scale) ** 2:
                return seen
        finest -= 1
        found.insert(0, blobs_of(levels[finest]))


def _inside_frame(outlines: Outlines, size: tuple[int, int]) -> np.ndarray:
    """Tell which outlines lie in the frame as a whole."""
    extent = np.sqrt(np.diagonal(outlines.shape, axis1=1, axis2=2))
    low, high = outlines.centre - extent, outlines.centre + extent
    inside: np.ndarray = ((low > -_MARGIN) & (high < np.array(size) - 1 + _MARGIN)).all(axis=1)
    return inside


def _choose(
    lattices: list[Lattice], outlines: Outlines, target: DotGrid
) -> tuple[Lattice, Numbering] | Refusal:
    """Return the one lattice that carries the target's rings."""
    if len(outlines.centre) == 0:
        return Refusal.NO_DOTS
    if len(outlines.centre) < _FEWEST_DOTS:
        return Refusal.TOO_FEW_DOTS
    if not lattices:
        return Refusal.NO_GRID
    outcomes = [(lattice, number_lattice(lattice, outlines, target)) for lattice in lattices]
    named = [(lattice, outcome) for lattice, outcome in outcomes if isinstance(outcome, Numbering)]
    if len(named) > 1 or any(outcome is Refusal.AMBIGUOUS_RINGS for _, outcome in outcomes):
        return Refusal.AMBIGUOUS_RINGS
    if not named:
        refusals = [outcome for _, outcome in outcomes if isinstance(outcome, Refusal)]
        return Refusal.MIRRORED if Refusal.MIRRORED in refusals else Refusal.NO_RINGS
    return named[0] if is_smooth(named[0][0], outlines.centre) else Refusal.GRID_INCONSISTENT


def _measured(
    grey: GreyPicture, lattice: Lattice, numbering: Numbering, outlines: Outlines, target: DotGrid
) -> list[_Dot]:
    """Return the dots of the lattice, fitted."""
    hole = target.ring_inner_diameter_mm / target.ring_outer_diameter_mm
    named = [(numbering.index(node), spot) for node, spot in lattice.spots.items()]
    spots = outlines.select(np.array([spot for _, spot in named]))
    holes = np.array([hole if index in target.ring_indices else 0.0 for index, _ in named])
    fits = fit_edges(grey, spots, holes, clear_reach(target))
    usual = float(np.median(fits.departure[fits.ok])) if fits.ok.any() else 0.0
    clean = fits.ok & (fits.departure <= _DEPARTURE[0] * usual + _DEPARTURE[1] * spots.radius)
    return [
        _named_dot(number, index, fits, target)
        if clean[number]
        else _Dot(index, DotFlag.BAD_FIT, spots.centre[number], spots.shape[number])
        for number, (index, _) in enumerate(named)
    ]


def _named_dot(number: int, index: tuple[int, int], fits: EdgeFits, target: DotGrid) -> _Dot:
    """Return a measured dot."""
    inside = 0 <= index[0] < target.cols and 0 <= index[1] < target.rows
    flag = DotFlag.OK if inside else DotFlag.BEYOND_GRID
    centre = fits.centre[number]
    return _Dot(index, flag, centre, fits.shape[number], centre, fits.covariance[number])


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
