"""The whole print of a ChArUco board, squares and cells of markers, as lines and cells between them."""

from dataclasses import dataclass

import numpy as np

from labcal.detect.corners.printed_kernel import PrintLines
from labcal.targets.charuco import CharucoBoard
from labcal.targets.charuco_opencv import markers


@dataclass(frozen=True)
class BoardPrint:
    """The print of a board.

    Attributes
    ----------
    lines : PrintLines
    x_kinds, y_kinds : ndarray of int
        Number of each line among those of its marker, along x and then along y; -1 for lines of squares.
    count : int
        Of these numbers.
    """

    lines: PrintLines
    x_kinds: np.ndarray
    y_kinds: np.ndarray
    count: int


def board_print(board: CharucoBoard) -> BoardPrint:
    """Return the print of a board in squares, with its corner (0, 0) at (0, 0); what is around it is white.

    Parameters
    ----------
    board : CharucoBoard
    """
    printed = markers(board)
    count = printed.is_black.shape[1]
    within = board.corner_gap + board.marker_mm / board.square_mm / count * np.arange(count + 1)
    inner = np.concatenate([[0.0], within])
    x_lines, y_lines = (
        np.append((np.arange(-1, squares - 1)[:, None] + inner).ravel(), squares - 1.0)
        for squares in board.squares
    )
    span = len(inner)
    cells = np.ones((len(x_lines) + 1, len(y_lines) + 1))
    i, j = np.indices(board.squares)
    for a, b in np.argwhere(board.is_black(i, j)).tolist():
        cells[1 + span * a : 1 + span * (a + 1), 1 + span * b : 1 + span * (b + 1)] = -1.0
    squares = np.floor(printed.corner / board.square_mm).astype(int) + 1
    for (a, b), black in zip(squares.tolist(), printed.is_black, strict=True):
        # The first interval of a square is the white before its marker. Rows of cells run down.
        col, row = 2 + span * a, 2 + span * b
        cells[col : col + count, row : row + count] = np.where(black[::-1], -1.0, 1.0).T
    kinds = [np.concatenate([[-1], axis * (count + 1) + np.arange(count + 1)]) for axis in (0, 1)]
    x_kinds, y_kinds = (
        np.append(np.tile(own, squares), -1) for own, squares in zip(kinds, board.squares, strict=True)
    )
    return BoardPrint(PrintLines(x_lines, y_lines, cells), x_kinds, y_kinds, 2 * (count + 1))
