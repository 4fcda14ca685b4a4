"""Outlines of the print of a chessboard, in millimetres in the target's frame."""

import numpy as np
from matplotlib.path import Path as Outline

from labcal.targets.chessboard import Chessboard

_SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]])
_CODES = np.array([Outline.MOVETO, Outline.LINETO, Outline.LINETO, Outline.LINETO, Outline.CLOSEPOLY])


def chessboard_outlines(board: Chessboard) -> Outline:
    """Return the outlines of the black squares and of the marks as one path.

    A mark in a black square runs the other way round, so that filling leaves it empty. Places are scaled as
    the print is.
    """
    across, up = board.squares
    i, j = (k.ravel() for k in np.meshgrid(np.arange(across), np.arange(up)))
    black = board.is_black(i, j)
    corners = np.stack([i[black] - 1.0, j[black] - 1.0], axis=-1)
    vertices = [(corners[:, None] + _SQUARE).reshape(-1, 2)]
    codes = [np.tile(_CODES, len(corners))]
    circle = Outline.unit_circle()
    round_, kinds = np.asarray(circle.vertices), np.asarray(circle.codes)
    # The last vertex belongs to "close" and has no place of its own.
    hole = np.concatenate([round_[-2::-1], round_[-1:]])
    for square in board.marks:
        middle = np.array(square) - 0.5
        is_hole = bool(board.is_black(np.array(square[0]), np.array(square[1])))
        vertices.append(middle + 0.5 * board.mark_share * (hole if is_hole else round_))
        codes.append(kinds)
    return Outline(np.concatenate(vertices) * board.square_mm * board.scale_x_y, np.concatenate(codes))
