"""The print of a ChArUco board as a function of the place on it, to draw pictures from."""

import numpy as np

from labcal.bench.boards.cell_print import cell_ink
from labcal.bench.marks.drawn_picture import Print
from labcal.targets.charuco import CharucoBoard
from labcal.targets.charuco_opencv import markers

PAPER_SQUARES = 0.5
"""White paper around the squares."""
_BEYOND = 0.6
"""Share of ink of what lies behind the paper."""


def charuco_ink(board: CharucoBoard) -> Print:
    """Return the share of ink at places of a print, mm in the target's frame.

    Parameters
    ----------
    board : CharucoBoard
    """
    printed = markers(board)
    cells = printed.is_black.shape[1]
    within = board.square_mm * board.corner_gap + board.marker_mm / cells * np.arange(cells + 1)
    axes = []
    for count in board.squares:
        starts = board.square_mm * np.arange(-1, count)
        inner = (starts[:-1, None] + np.concatenate([[0.0], within])).ravel()
        rim = PAPER_SQUARES * board.square_mm
        axes.append(np.concatenate([[starts[0] - rim], inner, [starts[-1], starts[-1] + rim]]))
    x_lines, y_lines = axes
    share = np.full((len(y_lines) + 1, len(x_lines) + 1), _BEYOND)
    share[1:-1, 1:-1] = 0.0
    span = cells + 2  # intervals of a square
    for j in range(board.squares[1]):
        for i in range(board.squares[0]):
            if bool(board.is_black(np.array(i), np.array(j))):
                share[2 + span * j : 2 + span * (j + 1), 2 + span * i : 2 + span * (i + 1)] = 1.0
    for (x, y), black in zip(printed.corner, printed.is_black, strict=True):
        i, j = (int(np.floor(place / board.square_mm)) + 1 for place in (x, y))
        row, col = 3 + span * j, 3 + span * i
        share[row : row + cells, col : col + cells] = black[::-1]
    return cell_ink(x_lines, y_lines, share)
