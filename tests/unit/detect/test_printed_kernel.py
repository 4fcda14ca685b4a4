"""The blurred print around a corner."""

import numpy as np
import pytest
from scipy.special import ndtr

from labcal.bench.boards.charuco_picture import COARSE
from labcal.detect.corners.board_print import board_print
from labcal.detect.corners.corner_judgement import JudgementLimits, judged_rows, place_error
from labcal.detect.corners.printed_kernel import FREE, ROWS, PrintLines, empty_rows, fill_printed
from labcal.detect.corners.printed_lines import line_derivatives
from labcal.detect.corners.printed_place import LocalMap
from labcal.detect.row_products import filled_up
from labcal.detect.stage_settings.corner import CornerSettings

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


def test_lines_that_do_not_show_change_nothing() -> None:
    # Cells change along x only, whatever lines there are along y: the blur across the edge alone counts.
    # Between oblique axes blurs are joined by nodes, which left errors of 1e-5 of the step and more.
    oblique = np.array([[1.0, 0.14], [0.0, 1.0]]) / SQUARE_PX
    around = MIDDLE._replace(at=np.zeros(2), linear=oblique)
    hidden = PrintLines(np.array([-0.1, 0.0]), np.arange(-3.0, 4.0) / 8.0, np.full((3, 8), -1.0))
    hidden.cells[2] = 1.0
    rows, state = (
        empty_rows(OFFSET.shape[1]),
        np.array([0.0, 0.0, 0.0, 0.0, 1.5, 1.5, 0.5, 0.4, 0.0, 0.0, 0.0]),
    )
    fill_printed(state, (OFFSET, np.zeros(OFFSET.shape[1])), around, hidden, rows)
    away = (oblique[0] @ OFFSET) / (1.5 * np.hypot(*oblique[0]))
    np.testing.assert_allclose(rows[2], 2.0 * ndtr(away) - 1.0, rtol=0, atol=4e-6)


def test_pixels_far_from_all_edges_tell_levels_alone() -> None:
    lines = PrintLines(np.array([0.0]), np.array([0.0]), np.array([[1.0, -1.0], [-1.0, 1.0]]))
    offset, state = (
        np.array([[9.0, -9.0], [9.0, 9.0]]),
        np.array([*np.zeros(4), 1.0, 1.0, 5.0, 4.0, 0.01, 0.0, 0.1]),
    )
    rows = empty_rows(2)
    fill_printed(state, (offset, np.array([9.0, 1.0])), MIDDLE._replace(at=np.zeros(2)), lines, rows)
    light = 1.0 + 0.01 * offset[0] + 0.5 * (0.01 * offset[0]) ** 2
    np.testing.assert_allclose(rows[2], [1.0, -1.0])
    np.testing.assert_allclose(rows[1][4:6], [light, light * rows[2]])
    np.testing.assert_allclose(rows[0], np.array([9.0, 1.0]) - light * (5.0 + 4.0 * rows[2]))
    assert not np.delete(rows[1], (4, 5), axis=0).any()


def test_the_error_of_a_place_is_that_of_its_covariance() -> None:
    random = np.random.default_rng(4)
    table, limits = np.zeros((ROWS, filled_up(298))), CornerSettings().limits(JudgementLimits)
    table[: FREE + 1, :298] = random.normal(size=(FREE + 1, 298))
    board, away, mask = (
        random.uniform(-1.0, 1.0, 298),
        random.normal(size=(2, 298)),
        np.ones((2, 149), dtype=bool),
    )
    prior = np.diag(random.uniform(0.0, 50.0, FREE))
    judged = judged_rows((table, board, np.abs(away[0])), away, mask, prior, limits)
    root = np.linalg.cholesky(table[:FREE] @ table[:FREE].T + prior)
    error = place_error(table, board, (root, prior), limits)
    assert error == pytest.approx(np.sqrt(0.5 * np.trace(judged[1])), rel=1e-9)
