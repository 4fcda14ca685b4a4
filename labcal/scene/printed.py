"""Properties of a target of any kind that the laboratory needs to print it and to place it."""

import numpy as np
from jaxtyping import Float64

from labcal.targets.board_set import BoardSet
from labcal.targets.chessboard import Chessboard
from labcal.targets.grid import DotGrid, GridIndex
from labcal.targets.target import PrintableTarget


def steps_mm(target: PrintableTarget) -> Float64[np.ndarray, "2"]:
    """Return the distance from column to column and from row to row, mm; of several boards, of the first."""
    if isinstance(target, BoardSet):
        target = target.targets[0]
    places = target.points(np.array([[0, 0], [1, 0], [0, 1]]))
    return np.array([places[1, 0] - places[0, 0], places[2, 1] - places[0, 1]])


def key_indices(target: PrintableTarget) -> tuple[GridIndex, ...]:
    """Return (col, row) of the places that must be seen to number the others: none where all are coded.

    Of a chessboard these are the corners of the squares with marks; of one without marks all corners. Of
    boards side by side these are those of each, with their numbers in the set.
    """
    if isinstance(target, BoardSet):
        return tuple(
            (span.start + row * board.cols + col, 0)
            for board, span in zip(target.targets, target.spans, strict=True)
            for col, row in key_indices(board)
        )
    if isinstance(target, DotGrid | Chessboard):
        return target.key_indices
    return ()
