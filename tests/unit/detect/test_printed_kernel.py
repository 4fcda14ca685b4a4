"""The blurred print around a corner where its blur reaches the whole board."""

import numpy as np

from labcal.bench.boards.charuco_picture import COARSE
from labcal.detect.corners.board_print import board_print
from labcal.detect.corners.printed_kernel import empty_rows, fill_printed
from labcal.detect.corners.printed_lines import line_derivatives
from labcal.detect.corners.printed_place import LocalMap

SQUARE_PX = 20.0
MIDDLE = LocalMap(
    np.array([3.5, 2.5]), np.eye(2) / SQUARE_PX, np.zeros((2, 3)), np.zeros(2), np.zeros((2, 4))
)
OFFSET = np.random.default_rng(3).uniform(-8.0, 8.0, (2, 40))


def _state(*corner: float) -> np.ndarray:
    """Return a state whose blur reaches all lines of the board from its middle, as that of a run-away fit."""
    blur = 1.2 * SQUARE_PX
    return np.array([*corner, 0.0, 0.5 * np.pi, blur, blur, 0.5, 0.4, 0.0, 0.0, 0.0])


def test_derivatives_are_right_where_the_blur_reaches_more_than_sixty_lines() -> None:
    # Of a board of 9 x 7 squares with 4 x 4 markers that are 73 lines along x. Arrays that hold fewer were
    # written beyond their end: the derivatives were wrong, and the process ended by "double free".
    lines = board_print(COARSE).lines
    assert len(lines.x) > 64
    rows, step = empty_rows(OFFSET.shape[1]), 1.0
    value = np.zeros(OFFSET.shape[1])
    models = []
    for x in (-step, step):
        fill_printed(_state(x, 0.0), (OFFSET, value), MIDDLE, lines, rows)
        models.append(-rows[0])
    fill_printed(_state(0.0, 0.0), (OFFSET, value), MIDDLE, lines, rows)
    change = (models[1] - models[0]) / (2.0 * step)
    assert np.abs(rows[1][0] - change).max() < 0.02 * np.abs(change).max()


def test_lines_move_a_picture_whose_blur_reaches_them_all() -> None:
    # All lines along x move as one: the picture moves by as much as the corner.
    lines = board_print(COARSE).lines
    out, rows = np.empty((1, OFFSET.shape[1])), empty_rows(OFFSET.shape[1])
    kinds = np.zeros(len(lines.x), dtype=np.int64), np.full(len(lines.y), -1)
    line_derivatives(_state(0.0, 0.0), OFFSET, (MIDDLE, lines), kinds, out)
    fill_printed(_state(0.0, 0.0), (OFFSET, np.zeros(OFFSET.shape[1])), MIDDLE, lines, rows)
    assert np.abs(np.abs(out[0]) - np.abs(rows[1][0]) * SQUARE_PX).max() < 0.02 * np.abs(out[0]).max()
