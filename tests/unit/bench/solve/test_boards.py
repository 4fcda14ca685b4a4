"""Checks of calibrations by boards: what they let pass, and what not."""

import numpy as np
import pytest

from labcal.bench.solve.board_figures import BoardFigures
from labcal.bench.solve.board_set import BoardSet, measured_board_set
from labcal.bench.solve.boards import board_checks, coverage_check
from labcal.bench.solve.camera_errors import CameraErrors

GOOD = BoardFigures(
    pictures=32, indexed=32, wrong=0, places=1700, error_px=0.02, stated_px=0.02, normalised=1.0,
    residual=1.0, parameters=24, mean_square=1.0, worst=2.1, coverage=0.95, error_mm=0.1,
    stated_mm=0.1, warned=False,
)  # fmt: skip


@pytest.mark.parametrize(
    ("changed", "fails"),
    [
        ({}, ""),
        ({"indexed": 30}, "not indexed"),
        ({"wrong": 1}, "wrong ids"),
        ({"mean_square": 1.4}, "mean square of 120 errors"),
        ({"worst": 4.2}, "worst of 120 parameters"),
        ({"coverage": 0.7}, "coverage"),
        ({"error_px": 0.03}, "over the one stated"),
        ({"warned": True}, "warns of"),
    ],
)
def test_each_fault_fails_its_check_alone(changed: dict[str, object], fails: str) -> None:
    sets = [GOOD.model_copy(update=changed)] * 5
    failed = [check.name for check in board_checks("chessboard", sets) if not check.ok]
    assert len(failed) == bool(fails)
    assert all(fails in name for name in failed)


def test_a_board_covers_as_dots_do_but_for_chance() -> None:
    dots = [GOOD.model_copy(update={"coverage": share}) for share in (0.93, 0.97, 0.95)]
    near, far = ([GOOD.model_copy(update={"coverage": 0.95 - less})] * 3 for less in (0.01, 0.3))
    assert coverage_check("chessboard", near, dots).ok
    assert not coverage_check("chessboard", far, dots).ok


def test_errors_of_parameters_are_in_units_of_their_covariance() -> None:
    errors = CameraErrors(np.array([2.0, -3.0]), np.diag([4.0, 1.0]))
    assert errors.sigmas.tolist() == [1.0, 3.0]
    assert errors.mean_square == 5.0


@pytest.mark.slow
def test_a_set_of_chessboards_is_calibrated_as_stated() -> None:
    found = measured_board_set(BoardSet("chessboard", 0))
    assert found.wrong == 0
    assert found.indexed >= found.pictures - 2
    assert found.worst < 4.0
    assert found.coverage > 0.9
