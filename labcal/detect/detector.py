"""From a picture to its dots: the stages of detection in order."""

from collections import Counter
from dataclasses import dataclass, replace

import numpy as np

from labcal.detect.dots import PictureDots
from labcal.detect.edge_fit import fit_edges
from labcal.detect.flags import SPOILT, DotFlag, Refusal
from labcal.detect.grey import AnyPicture, GreyPicture, grey_picture
from labcal.detect.lost import lost_dots
from labcal.detect.numbering import AnyNumbering
from labcal.detect.outlines import Outlines, clear_reach
from labcal.detect.plain import goes_on, with_lookalikes
from labcal.detect.prediction import Predictor
from labcal.detect.probe import with_missed
from labcal.detect.search import cause, search
from labcal.detect.shapes import odd_shapes
from labcal.geometry.two_by_two import eigenvalues
from labcal.targets.catalogue import AnyTarget
from labcal.targets.grid import DotGrid, Polarity
from labcal.targets.registry import function_of, kind_of

# An outline further from its ellipse is not measured: times the usual departure of the picture's dots (a
# print may be ragged, a renderer's discs are polygons), and of the radius.
_DEPARTURE = (2.5, 0.001)
_BLURRED = 0.6  # of the minor axis
_CLIPPED = 0.06
_MISFIT, _RING_MISFIT = (
    1.5,
    2.0,
)  # of the usual noise; clean dots of the photographs reach 1.4, and small rings,
# whose holes shine into the fit, 1.6
_PALE = 0.2  # of the step; what hides part of a small dot. Rings lighten with their holes, so they may
_USABLE = 0.1  # of the dots that are whole in the picture; what is left where fewer fit is left by chance
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
    misfit: float = np.nan


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
    found = _detect_dots(image, target)
    return found.unusable() if found.indexed and _hardly_measured(found) else found


def _hardly_measured(dots: PictureDots) -> bool:
    """Tell whether hardly any of the dots that are whole in the picture could be measured."""
    usable = int(dots.ok.sum())
    whole = usable + sum(flag in SPOILT for flag in dots.flag)
    return usable == 0 or usable < _USABLE * whole


def _detect_dots(image: AnyPicture, target: AnyTarget) -> PictureDots:
    """Find dots or corners with the detector of the target's kind."""
    grey = grey_picture(image)
    if np.shares_memory(grey, image):
        grey = grey.copy()  # a detector may work in place, since it may be large
    found: PictureDots = function_of(kind_of(target).detector)(grey, target)
    return found


def detect_grid_dots(grey: GreyPicture, target: DotGrid) -> PictureDots:
    """Find the dots of a grid in a picture, which is turned into its negative in place where that helps."""
    black = 0.0
    if target.polarity is Polarity.WHITE_ON_BLACK:
        black = _invert(grey, black)
    first = _detect(grey, target, target.polarity, black)
    if first.indexed:
        return first
    black = _invert(grey, black)
    other = Polarity.WHITE_ON_BLACK if target.polarity is Polarity.BLACK_ON_WHITE else Polarity.BLACK_ON_WHITE
    second = _detect(grey, target, other, black)
    return second if second.indexed else first


def _invert(grey: GreyPicture, black: float) -> float:
    """Turn a picture into its negative, in place; return its grey value of no light, which was `black`."""
    if grey.size == 0:
        return black
    largest = grey.max()
    np.subtract(largest, grey, out=grey)
    return float(largest) - black


def _detect(grey: GreyPicture, target: DotGrid, polarity: Polarity, black: float) -> PictureDots:
    """Detect dots of one polarity, which are dark in `grey`; `black` is the grey value of no light."""
    size = (grey.shape[1], grey.shape[0])
    seen = search(grey, target)
    if isinstance(seen.grid, Refusal):
        refusal = cause(seen.grid, grey, seen.whole)
        return _collect(_unnamed(seen.whole.joined(seen.cut), set()), size, polarity, refusal)
    lattice, numbering = seen.grid
    lattice, outlines = with_missed(grey, lattice, numbering, seen.whole, target)
    predictor = Predictor(lattice, outlines)
    lost = lost_dots(predictor, seen.blobs, size, lambda node: target.holds(*numbering.index(node)))
    if target.rings is None and goes_on(lost, numbering, target):
        return _collect(_unnamed(seen.whole.joined(seen.cut), set()), size, polarity, Refusal.AMBIGUOUS)
    dots = _measured((grey, black), predictor, numbering, target)
    dots += [_Dot(numbering.index(dot.node), dot.flag, dot.seen_at, dot.outline) for dot in lost]
    spots, taken = list(lattice.spots.values()), np.array([dot.seen_at for dot in dots])
    typical = float(np.median(outlines.radius[spots]))
    unnamed = _unnamed(outlines.joined(seen.cut), set(spots))
    dots += [dot for dot in unnamed if _alike(dot, typical) and _is_apart(dot, taken)]
    return with_lookalikes(_collect(_one_an_id(dots), size, polarity, None), target)


def _measured(
    picture: tuple[GreyPicture, float], predictor: Predictor, numbering: AnyNumbering, target: DotGrid
) -> list[_Dot]:
    """Return the dots of a lattice, fitted in a picture with its grey value of no light."""
    lattice, outlines, hole = predictor.lattice, predictor.outlines, target.hole_share
    named = [(numbering.index(node), spot) for node, spot in lattice.spots.items()]
    spots = outlines.select(np.array([spot for _, spot in named]))
    holes = np.array([hole if index in target.ring_indices else 0.0 for index, _ in named])
    fits = fit_edges(picture[0], spots, holes, clear_reach(target), picture[1])
    usual = float(np.median(fits.departure[fits.ok])) if fits.ok.any() else 0.0
    rough = fits.departure > _DEPARTURE[0] * usual + _DEPARTURE[1] * spots.radius
    shape = outlines.shape.copy()
    shape[list(lattice.spots.values())] = np.where(fits.ok[:, None, None], fits.shape, spots.shape)
    rough |= (fits.misfit > np.where(holes > 0.0, _RING_MISFIT, _MISFIT)) | (
        (fits.paleness > _PALE) & (holes == 0.0)
    )
    rough |= odd_shapes(predictor, replace(outlines, shape=shape), target)
    minor = np.sqrt(eigenvalues(spots.shape)[:, 0])
    dots = []
    for number, (index, _) in enumerate(named):
        seen_at, outline = spots.centre[number], spots.shape[number]
        if spots.blur[number] > _BLURRED * minor[number]:
            dots.append(_Dot(index, DotFlag.BLURRED, seen_at, outline))
        elif fits.ok[number] and (fits.burnt_out or fits.clipped[number] > _CLIPPED):
            dots.append(_Dot(index, DotFlag.SATURATED, seen_at, outline))
        elif not fits.ok[number] or rough[number]:
            dots.append(_Dot(index, DotFlag.BAD_FIT, seen_at, outline))
        else:
            flag = DotFlag.OK if target.holds(*index) else DotFlag.BEYOND_GRID
            centre = fits.centre[number]
            told = (centre, fits.covariance[number], float(fits.misfit[number]))
            dots.append(_Dot(index, flag, centre, fits.shape[number], *told))
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


def _is_apart(dot: _Dot, taken: np.ndarray) -> bool:
    """Tell whether a spot is none of the dots at places (n, 2), which were looked for once more."""
    away = np.linalg.norm(taken - dot.seen_at, axis=1).min()
    return bool(away > 0.5 * np.linalg.det(dot.outline) ** 0.25)


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
        misfit=np.array([dot.misfit for dot in dots], dtype=np.float64),
        flag=tuple(dot.flag for dot in dots),
        seen_at=np.array([dot.seen_at for dot in dots], float).reshape(-1, 2),
        outline=np.array([dot.outline for dot in dots], float).reshape(-1, 2, 2),
    )
