"""A ChArUco board placed by the lattice of its corners and the likeness of all squares to its codes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int
from scipy.stats import norm

from labcal.detect.corners.board_lattice import find_board_lattices, lattice_colours
from labcal.detect.corners.code_likeness import CodeLikeness, board_codes, seen_cells, turned_codes
from labcal.detect.corners.corners import Corners, measured_corners
from labcal.detect.corners.node_grid import NodeGrid
from labcal.detect.corners.reduced import Reduced, reduced_pictures
from labcal.detect.corners.saddles import Saddles, find_saddles
from labcal.detect.grey import GreyPicture
from labcal.detect.lattice.lattice import Lattice
from labcal.detect.lattice.rings import TURNS
from labcal.detect.lattice.rough_undistortion import NONE
from labcal.detect.settings import DetectSettings
from labcal.detect.stage_settings.corner import CornerSettings
from labcal.targets.charuco import CharucoBoard

_OVERHANG = 2
"""Lines of false corners, of the paper's rim, by which a lattice may go beyond the board."""

_LEAST_DEVIATION = 1e-9
"""Of squares without any code in them, even ones, steps."""

_FINE = 2
"""Reduction of a picture in which the smallest squares are still seen."""

_LEAST_SADDLES = 4
"""Saddle points in a picture of half the size in which a board may be: those of 60 drawn boards had 26."""

_UNLIKE = 0.5
"""Likeness of a square to its code, of the most of all squares, below which it speaks against a place."""

_JUDGED = 2
"""Times that a lattice is judged: as it is found, and with corners that are looked for beside it."""

_RINGS = (1.0, 0.7)
"""Radii of the rings that are read around corners, of the usual one: beside small squares lie markers."""


@dataclass(frozen=True)
class _Place:
    """A place of a lattice on the board, and how far its squares are like the codes there, beyond chance."""

    turn: int
    shift: Int[np.ndarray, " 2"]
    sigmas: float
    without_best: float
    """The same without the square that tells most."""
    against: float
    """Share of the evidence in squares that are much less like their codes than the clearest one."""


@dataclass(frozen=True)
class _Squares:
    """Whole white squares of a lattice.

    Attributes
    ----------
    first : ndarray of int, shape (n, 2)
        Their lowest nodes.
    corners : ndarray, shape (n, 4, 2)
        From that node on around, px.
    steps : ndarray, shape (n,)
        From black to white, grey values.
    """

    first: Int[np.ndarray, "n 2"]
    corners: np.ndarray
    steps: np.ndarray


def corners_by_codes(grey: GreyPicture, board: CharucoBoard, settings: DetectSettings) -> Corners:
    """Return the corners of a board whose markers are too far, too blurred or too worn to be read one by one.

    The corners of the squares form a lattice, as those of a chessboard. At every place that a lattice may
    have on the board, by the colours of its squares, the picture is correlated with the codes that the
    board has there; chance is what codes of the same dictionary in other squares give. That place is taken
    where all squares together are more like their codes than chance would have it once in so many millions
    of pictures (`code_false_alarm_share`), not by a single square, where hardly any square is unlike its
    code, as half of them are on a board of the other pattern or with more columns, and where no line
    of corners goes on beyond the board.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    board : CharucoBoard
    settings : DetectSettings

    Returns
    -------
    Corners
        Rough places with ids; none where nothing is certain.
    """
    for level in reduced_pictures(grey, settings):
        for share in _RINGS if level.factor == 1 else _RINGS[:1]:  # half the size has the smaller ring, too
            near = settings.saddle.model_copy(
                update={
                    "ring_px": share * settings.saddle.ring_px,
                    "blur_px": share * settings.saddle.blur_px,
                }
            )
            saddles = find_saddles(level.grey, near)
            for lattice in find_board_lattices(saddles, max(board.cols, board.rows), NONE, settings):
                corners = _placed(level, (lattice, saddles), board, settings)
                if len(corners.index):
                    return corners
            if level.factor <= _FINE and len(saddles.place) < _LEAST_SADDLES:
                return Corners.none()
    return Corners.none()


def _placed(
    level: Reduced, seen: tuple[Lattice, Saddles], board: CharucoBoard, settings: DetectSettings
) -> Corners:
    """Return the corners of a lattice, if its codes tell where on the board it is.

    Where they say so, but not surely enough, corners are looked for beside the lattice as if it lay there,
    and all squares between these are judged.
    """
    lattice, saddles = seen
    nodes = np.array(list(lattice.spots), dtype=np.int64)
    spots = np.array(list(lattice.spots.values()), dtype=np.int64)
    places = _places(level, nodes, _white_squares(lattice, saddles), board, settings)
    if not places:
        return Corners.none()
    best = places[0]
    index = nodes @ TURNS[best.turn].T + best.shift
    own = ((index >= 0) & (index < [board.cols, board.rows])).all(axis=1)
    if _goes_on(index, board, settings.saddle.min_line_share):
        return Corners.none()
    found = Corners(index[own], saddles.place[spots[own]], [None] * int(own.sum()))
    if not _is_certain(places, settings.corner):
        if best.sigmas < settings.corner.min_code_sigma:
            return Corners.none()
        found = _grown(level.grey, board, found, settings)
        if len(found.index) == 0:
            return found
        places = _places(level, found.index, _squares_between(found, board), board, settings)
        stays = bool(places) and places[0].turn == 0 and not places[0].shift.any()
        if not (stays and _is_certain(places, settings.corner)):
            return Corners.none()
    return Corners(found.index, level.in_full(found.seen_at), [None] * len(found.index))


def _is_certain(places: Sequence[_Place], settings: CornerSettings) -> bool:
    """Tell whether the codes are like those of the first place beyond chance, and of no other one."""
    best, looks = places[0], len(_RINGS) * _JUDGED
    enough = float(norm.isf(settings.code_false_alarm_share / len(places) / looks))
    certain = best.sigmas > enough and best.without_best > settings.min_code_sigma
    certain &= best.against < settings.max_code_contradiction_share
    return certain and (len(places) == 1 or best.sigmas - places[1].sigmas > settings.min_code_sigma)


def _grown(grey: GreyPicture, board: CharucoBoard, known: Corners, settings: DetectSettings) -> Corners:
    """Return the corners that are fitted, from known ones on."""
    found = measured_corners(grey, board, known, settings)
    return found.select(np.flatnonzero([fit is not None for fit in found.fits]))


def _squares_between(corners: Corners, board: CharucoBoard) -> _Squares:
    """Return the whole white squares between fitted corners."""
    low, high = corners.index.min(axis=0), corners.index.max(axis=0)
    i, j = np.mgrid[low[0] : high[0] + 1, low[1] : high[1] + 1] + 1
    white = ~board.is_black(i.ravel(), j.ravel()).reshape(i.shape)
    steps = np.array([fit.step for fit in corners.fits if fit is not None])
    return _whole_squares(corners.index, white, corners.seen_at, steps)


def _white_squares(lattice: Lattice, saddles: Saddles) -> _Squares:
    """Return the whole white squares of a lattice."""
    nodes = np.array(list(lattice.spots), dtype=np.int64)
    spots = np.array(list(lattice.spots.values()), dtype=np.int64)
    low = nodes.min(axis=0)
    grid = np.full(nodes.max(axis=0) - low + 1, -1)
    grid[tuple((nodes - low).T)] = spots
    a, b = np.indices(grid.shape)
    phase = np.where((a + b) % 2 == 0, 1, -1)
    white = phase * np.sign((lattice_colours(grid, saddles) * phase).sum()) > 0
    return _whole_squares(nodes, white, saddles.place[spots], saddles.step[spots])


def _whole_squares(nodes: np.ndarray, white: np.ndarray, place: np.ndarray, step: np.ndarray) -> _Squares:
    """Return the squares all of whose corners are known.

    Parameters
    ----------
    nodes : ndarray of int, shape (n, 2)
        Of the corners.
    white : ndarray of bool, shape (a, b)
        Whether the square between the axes is, at all nodes of the rectangle that these take up.
    place, step : ndarray, shapes (n, 2) and (n,)
        Of the corners, px and grey values.
    """
    seen = NodeGrid(nodes).spread(np.column_stack([place, step]))
    around = np.stack([seen[:-1, :-1], seen[1:, :-1], seen[1:, 1:], seen[:-1, 1:]], axis=2)
    whole = np.isfinite(around[..., 0]).all(axis=2) & white[:-1, :-1]
    corners = around[whole]
    return _Squares(np.argwhere(whole) + nodes.min(axis=0), corners[..., :2], corners[..., 2].mean(axis=1))


def _places(
    level: Reduced, nodes: np.ndarray, white: _Squares, board: CharucoBoard, settings: DetectSettings
) -> list[_Place]:
    """Return all places of a lattice on a board at which white squares are white, the likeliest first."""
    squares = white.first
    if len(squares) < settings.corner.min_code_squares:
        return []
    likeness = CodeLikeness.of(seen_cells(level.grey, white.corners, white.steps, board), board.dictionary)
    codes, number = board_codes(board), _marker_numbers(board)
    found = []
    for turn, matrix in enumerate(TURNS):
        turned = turned_codes(codes, turn)
        low, high = (nodes @ matrix.T).min(axis=0), (nodes @ matrix.T).max(axis=0)
        middles = (squares + 0.5) @ matrix.T
        for right in range(-low[0] - _OVERHANG, board.cols - high[0] + _OVERHANG):
            for up in range(-low[1] - _OVERHANG, board.rows - high[1] + _OVERHANG):
                shift = np.array([right, up])
                at = np.rint(middles + shift + 0.5).astype(np.int64)
                on = np.flatnonzero(((at >= 0) & (at < board.squares)).all(axis=1))
                marker = number[tuple(at[on].T)]
                if len(on) == 0 or (marker < 0).any():
                    continue
                sigmas = likeness.sigmas(on, turned[marker])
                weight = np.maximum(likeness.deviation[on], _LEAST_DEVIATION)
                part = sigmas * weight
                total = float(part.sum() / np.sqrt((weight**2).sum()))
                rest = np.arange(len(on)) != part.argmax()
                without = float(part[rest].sum() / np.sqrt((weight[rest] ** 2).sum())) if rest.any() else 0.0
                unlike = sigmas < _UNLIKE * sigmas.max()
                against = float((weight[unlike] ** 2).sum() / (weight**2).sum())
                found.append(_Place(turn, shift, total, without, against))
    return sorted(found, key=lambda one: -one.sigmas)


def _marker_numbers(board: CharucoBoard) -> Int[np.ndarray, "cols rows"]:
    """Return the number of the marker in every square, counted from the lower left one; -1 in black ones."""
    number = np.full(board.squares, -1)
    i, j = np.indices(board.squares).reshape(2, -1)
    white = ~board.is_black(i, j)
    # Markers are counted row by row from the upper left one.
    order = np.lexsort((i[white], -j[white]))
    number[i[white][order], j[white][order]] = np.arange(board.marker_count)
    return number


def _goes_on(index: np.ndarray, board: CharucoBoard, share: float) -> bool:
    """Tell whether a line of corners goes on beyond the board, as of a board with more squares.

    At the rim of a board every other corner of the outermost squares may look like an inner one, so pairs of
    neighbours count.
    """
    for axis, count in enumerate((board.cols, board.rows)):
        for line in np.unique(index[:, axis]).tolist():
            if 0 <= line < count:
                continue
            beyond, last = (
                _neighbours(index[index[:, axis] == one, 1 - axis])
                for one in (line, 0 if line < 0 else count - 1)
            )
            if beyond >= share * max(last, 1):
                return True
    return False


def _neighbours(places: np.ndarray) -> int:
    """Return how many nodes of a line have the next one beside them."""
    return int(np.isin(places + 1, places).sum())
