"""A ChArUco board placed by the lattice of its corners and the likeness of all squares to its codes."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int
from scipy.stats import norm

from labcal.detect.corners.board_lattice import find_board_lattices, lattice_colours
from labcal.detect.corners.code_likeness import CodeLikeness, board_codes, seen_cells, turned_codes
from labcal.detect.corners.corners import Corners
from labcal.detect.corners.reduced import Reduced, reduced_pictures
from labcal.detect.corners.saddles import Saddles, find_saddles
from labcal.detect.grey import GreyPicture
from labcal.detect.lattice.lattice import Lattice
from labcal.detect.lattice.rings import TURNS
from labcal.detect.lattice.rough_undistortion import NONE
from labcal.detect.settings import DetectSettings
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
    """Return the corners of a lattice, if its codes tell where on the board it is."""
    lattice, saddles = seen
    nodes = np.array(list(lattice.spots), dtype=np.int64)
    spots = np.array(list(lattice.spots.values()), dtype=np.int64)
    squares, quads, steps = _white_squares(lattice, saddles)
    if len(squares) < settings.corner.min_code_squares:
        return Corners.none()
    likeness = CodeLikeness.of(seen_cells(level.grey, quads, steps, board), board.dictionary)
    places = _places(nodes, squares, likeness, board)
    if not places:
        return Corners.none()
    places.sort(key=lambda one: -one.sigmas)
    best = places[0]
    enough = float(norm.isf(settings.corner.code_false_alarm_share / len(places) / len(_RINGS)))
    certain = best.sigmas > enough and best.without_best > settings.corner.min_code_sigma
    certain &= best.against < settings.corner.max_code_contradiction_share
    alone = len(places) == 1 or best.sigmas - places[1].sigmas > settings.corner.min_code_sigma
    index = nodes @ TURNS[best.turn].T + best.shift
    own = ((index >= 0) & (index < [board.cols, board.rows])).all(axis=1)
    if not (certain and alone) or _goes_on(index, board, settings.saddle.min_line_share):
        return Corners.none()
    place = level.in_full(saddles.place[spots[own]])
    return Corners(index[own], place, [None] * int(own.sum()))


def _white_squares(lattice: Lattice, saddles: Saddles) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the whole white squares of a lattice: their first nodes, their corners, and steps of grey."""
    nodes = np.array(list(lattice.spots), dtype=np.int64)
    low = nodes.min(axis=0)
    grid = np.full(nodes.max(axis=0) - low + 1, -1)
    grid[tuple((nodes - low).T)] = list(lattice.spots.values())
    a, b = np.indices(grid.shape)
    phase = np.where((a + b) % 2 == 0, 1, -1)
    white = phase * np.sign((lattice_colours(grid, saddles) * phase).sum()) > 0
    around = np.stack([grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]], axis=-1)
    whole = (around >= 0).all(axis=-1) & white[:-1, :-1]
    spots = around[whole]
    return np.argwhere(whole) + low, saddles.place[spots], saddles.step[spots].mean(axis=1)


def _places(
    nodes: np.ndarray, squares: np.ndarray, likeness: CodeLikeness, board: CharucoBoard
) -> list[_Place]:
    """Return all places of a lattice on a board at which white squares are white."""
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
    return found


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
