"""Ids of a chessboard's corners: by its outermost lines and colours, or by its marks."""

from dataclasses import dataclass, replace

import numpy as np

from labcal.detect.corners.board_lattice import lattice_colours
from labcal.detect.corners.board_marks import read_marks
from labcal.detect.corners.outer_lines import shows_line, shows_outer_lines
from labcal.detect.corners.saddles import Saddles
from labcal.detect.flags import Refusal
from labcal.detect.grey import GreyPicture
from labcal.detect.lattice.lattice import Lattice, Node
from labcal.detect.lattice.plain import turn_in_picture
from labcal.detect.lattice.rings import TURNS, Numbering
from labcal.detect.settings import DetectSettings
from labcal.detect.stage_settings.saddle import SaddleSettings
from labcal.targets.chessboard import Chessboard

_FEWEST_LINES = 3


@dataclass(frozen=True)
class SeenBoard:
    """A lattice of saddle points in a picture.

    Attributes
    ----------
    lattice : Lattice
    saddles : Saddles
    grey : ndarray, shape (h, w)
        The picture.
    """

    lattice: Lattice
    saddles: Saddles
    grey: GreyPicture


def number_board(seen: SeenBoard, board: Chessboard, settings: DetectSettings) -> Numbering | Refusal:
    """Find ids for a lattice.

    All four quarter turns are tried whose squares have the board's colours. Without marks a turn fits where
    the lattice has the board's number of columns and of rows, and each of the four outermost lines is seen,
    for the most part or with a few neighbouring corners. With marks it fits at a place where every mark that
    is seen is one of the board's, and no plain square is where the board has a mark. Of fitting turns that
    the board's own symmetry allows, that one is taken whose columns run most nearly to the right in the
    picture.

    Lines beyond the board's number that are not seen so are left out: corners of the outermost squares at
    the paper's rim, every other of which may look like an inner one.

    Returns
    -------
    Numbering or Refusal
        `BOARD_IN_PART` where there are fewer lines of corners than the board has, and no marks that number
        them; `OTHER_CHESSBOARD` where there are more, or colours or marks are not the board's; `AMBIGUOUS`
        where it fits at several places.
    """
    seen = replace(seen, lattice=_trimmed(seen.lattice, board, settings.saddle))
    nodes = np.array(list(seen.lattice.spots), dtype=np.int64)
    extent = np.sort(np.ptp(nodes, axis=0) + 1)
    lines = np.sort([board.cols, board.rows])
    if (extent > lines).any():
        return Refusal.OTHER_CHESSBOARD
    marks = read_marks(seen.lattice, seen.saddles, seen.grey, settings.saddle) if board.marks else {}
    are_read = sum(marks.values()) >= settings.saddle.min_marks
    places = _marked_places(seen, board, nodes, marks) if are_read else []
    if are_read and not places:
        return _of_other_marks(seen, board, nodes, marks)
    if not places:
        places = _whole_places(seen, board, nodes, settings.saddle)
    if len(places) > len(board.symmetric_turns()):
        return Refusal.AMBIGUOUS
    if not places:
        in_part = (extent < lines).any() or bool(board.marks) or not shows_outer_lines(nodes, settings.saddle)
        return Refusal.BOARD_IN_PART if in_part else Refusal.OTHER_CHESSBOARD
    where = seen.saddles.place[list(seen.lattice.spots.values())]
    return max(places, key=lambda one: np.cos(turn_in_picture((nodes @ one.turn.T).astype(float), where)))


def _trimmed(lattice: Lattice, board: Chessboard, settings: SaddleSettings) -> Lattice:
    """Return a lattice that is too long for a board without its sparse outermost lines."""
    spots = dict(lattice.spots)
    longest, shortest = max(board.cols, board.rows), min(board.cols, board.rows)
    while spots:
        nodes = np.array(list(spots), dtype=np.int64)
        extent = np.ptp(nodes, axis=0) + 1
        along = int(extent.argmax())
        axis = along if extent[along] > longest else 1 - along
        if extent[axis] <= (longest if axis == along else shortest):
            break
        ends = [int(nodes[:, axis].min()), int(nodes[:, axis].max())]
        lines = [nodes[nodes[:, axis] == end, 1 - axis] for end in ends]
        shown = [shows_line(line, int(extent[1 - axis]), settings) for line in lines]
        if all(shown):
            break
        sparse = min((0, 1), key=lambda end: (shown[end], len(lines[end])))
        spots = {node: spot for node, spot in spots.items() if node[axis] != ends[sparse]}
    return replace(lattice, spots=spots)


def _coloured_turns(seen: SeenBoard, board: Chessboard, nodes: np.ndarray) -> list[tuple[np.ndarray, int]]:
    """Return all quarter turns, each with the parity of the shift under which the colours are the board's."""
    grid = np.full(nodes.max(axis=0) - nodes.min(axis=0) + 1, -1)
    at = nodes - nodes.min(axis=0)
    grid[tuple(at.T)] = list(seen.lattice.spots.values())
    colours = lattice_colours(grid, seen.saddles)[tuple(at.T)]
    found = []
    for quarter, turn in enumerate(TURNS):
        # The square between a node's axes lies, on the board turned by a quarter, in the next quadrant.
        turned = nodes @ turn.T
        sign = colours * (-1) ** quarter
        # It is the square (col + 1, row + 1) of the board.
        white = np.where(board.is_black(turned[:, 0], turned[:, 1]), -1, 1)
        agree = int((sign * white).sum())
        found.append((turn, 0 if agree > 0 else 1))
    return found


def _whole_places(
    seen: SeenBoard, board: Chessboard, nodes: np.ndarray, settings: SaddleSettings
) -> list[Numbering]:
    """Return the numberings under which the lattice fills the board from edge to edge."""
    found = []
    for turn, parity in _coloured_turns(seen, board, nodes):
        places = nodes @ turn.T
        low, high = places.min(axis=0), places.max(axis=0)
        if (high - low + 1 != [board.cols, board.rows]).any() or low.sum() % 2 != parity:
            continue
        if shows_outer_lines(places, settings):
            found.append(Numbering(turn, -low))
    return found


def _of_other_marks(
    seen: SeenBoard, board: Chessboard, nodes: np.ndarray, marks: dict[Node, bool]
) -> Refusal:
    """Return the reason why marks that are seen are not the board's: in a mirror they may be."""
    swapped = {(b, a): marked for (a, b), marked in marks.items()}
    mirrored = SeenBoard(
        replace(seen.lattice, spots={(b, a): spot for (a, b), spot in seen.lattice.spots.items()}),
        seen.saddles,
        seen.grey,
    )
    fits = _marked_places(mirrored, board, nodes[:, ::-1], swapped)
    return Refusal.MIRRORED if fits else Refusal.OTHER_CHESSBOARD


def _marked_places(
    seen: SeenBoard, board: Chessboard, nodes: np.ndarray, marks: dict[Node, bool]
) -> list[Numbering]:
    """Return the numberings under which the marks that are seen are the board's."""
    squares, marked = np.array(list(marks), dtype=np.int64).reshape(-1, 2), np.array(list(marks.values()))
    wanted = np.zeros(board.squares, dtype=bool)
    wanted[tuple(np.array(board.marks).T)] = True
    found = []
    for turn, parity in _coloured_turns(seen, board, nodes):
        turned = nodes @ turn.T
        low, high = turned.min(axis=0), turned.max(axis=0)
        # The middle of square (col, row) of the board lies half a step below and left of corner (col, row).
        middles = np.rint((squares + 0.5) @ turn.T + 0.5).astype(np.int64)
        shifts = [
            np.array([right, up])
            for right in range(-low[0], board.cols - high[0])
            for up in range(-low[1], board.rows - high[1])
            if (right + up) % 2 == parity
        ]
        found += [
            Numbering(turn, shift) for shift in shifts if (wanted[tuple((middles + shift).T)] == marked).all()
        ]
    return found


def part_numberings(seen: SeenBoard, board: Chessboard) -> list[Numbering]:
    """Return every numbering under which a lattice is a part of a board of its colours, whatever its marks.

    Nothing where the lattice has fewer than three lines either way, or more than the board.
    """
    nodes = np.array(list(seen.lattice.spots), dtype=np.int64)
    if np.ptp(nodes, axis=0).min() + 1 < _FEWEST_LINES:
        return []
    found = []
    for turn, parity in _coloured_turns(seen, board, nodes):
        low, high = (nodes @ turn.T).min(axis=0), (nodes @ turn.T).max(axis=0)
        found += [
            Numbering(turn, np.array([right, up]))
            for right in range(-low[0], board.cols - high[0])
            for up in range(-low[1], board.rows - high[1])
            if (right + up) % 2 == parity
        ]
    return found
