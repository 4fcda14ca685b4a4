"""Solved sizes of rows, their medians, and rows that share a cause."""

from dataclasses import replace

import numpy as np
import pytest

from labcal.paper.explanations.board_problem import BoardProblem
from labcal.paper.explanations.cause_results import cause_results
from labcal.paper.explanations.cause_run import CauseOutcome, CauseRun, ReachedSize, errors_mm, solve_size
from labcal.paper.explanations.causes import cause_named
from labcal.paper.explanations.quotients import DIVISORS, divisor_results, quotient_rows
from labcal.paper.rows import row_named
from labcal.paper.training_run import TrainingOutcome
from labcal.report.figure_readings import FigureReading

HAND, RULER = "points picked by hand", "places by ruler, independent"


def test_the_size_of_a_displaced_origin_is_the_papers_figure(board: BoardProblem) -> None:
    """Row 19 prints 36.95 mm; both readings of it are the displacement itself."""
    found = solve_size(CauseRun(row_named("19"), "quadratic", "displaced origin", board, 0, 10))
    assert found.mean_signed.size == pytest.approx(36.95, rel=0.11)
    assert found.coordinate.size == pytest.approx(36.95, rel=0.11)


def test_noise_cancels_in_a_mean_but_not_in_an_rms(board: BoardProblem) -> None:
    found = solve_size(CauseRun(row_named("19"), "affine", HAND, board, 0, 10))
    assert found.mean_signed.size is None
    assert found.mean_signed.greatest_mm is not None
    assert found.mean_signed.greatest_mm < 36.95
    assert found.coordinate.size is not None
    _, rms = errors_mm(CauseRun(row_named("19"), "affine", HAND, board, 0, 10), found.coordinate.size)
    assert rms == pytest.approx(36.95, rel=0.15)


def test_a_method_that_cannot_be_fitted_has_no_size(board: BoardProblem) -> None:
    tilted = board.problem.Y + np.arange(130.0)[:, None] ** 2  # no plane of constant Z: no homography
    broken = replace(board, problem=replace(board.problem, Y=tilted))
    found = solve_size(CauseRun(row_named("19"), "homography", HAND, broken, 0, 10))
    assert found.coordinate == ReachedSize(size=None, greatest_mm=None)


def outcome(size: float | None, mean_signed: float | None) -> CauseOutcome:
    reached = ReachedSize(size=size, greatest_mm=9.0)
    return CauseOutcome(mean_signed=ReachedSize(size=mean_signed, greatest_mm=4.0), coordinate=reached)


def test_sizes_are_medians_and_shared_where_ranges_hold_them(board: BoardProblem) -> None:
    sizes = {"21": (4.0, 5.0, 6.0), "22": (4.5, None, 9.0), "23": (None, 60.0, None)}
    runs = [CauseRun(row_named(exp), "mlp", HAND, board, seed, 10) for exp in sizes for seed in range(3)]
    signed = {"21": 9.0}  # what row 22 needs under the other reading, which must not count
    outcomes = [outcome(size, signed.get(exp)) for exp, of_row in sizes.items() for size in of_row]
    results = cause_results(runs, outcomes)
    assert len(results) == 5
    hand = next(one for one in results if one.cause == HAND)
    assert not next(one for one in results if one.cause == RULER).rows
    rows = {row.exp: row for row in hand.rows if row.figure == FigureReading.COORDINATE}
    assert (rows["21"].size, rows["21"].size_range, rows["21"].also_gives) == (5.0, (4.0, 6.0), ("22",))
    assert (rows["22"].size, rows["22"].solved, rows["22"].also_gives) == (9.0, 2, ())
    assert np.isnan(rows["22"].size_range[1])
    assert np.isnan(rows["23"].size)
    assert (rows["21"].likely, rows["23"].likely) == (True, False)
    assert rows["21"].greatest_m == pytest.approx(0.009)
    means = {row.exp: row for row in hand.rows if row.figure == FigureReading.MEAN_SIGNED}
    assert (means["21"].size, means["21"].also_gives) == (9.0, ())
    assert np.isnan(means["22"].size)
    assert (means["22"].solved, means["22"].greatest_m) == (0, pytest.approx(0.004))
    assert cause_named(HAND).likely == hand.likely


def trained(mean_signed_mm: float, rmse_mm: float) -> TrainingOutcome:
    return TrainingOutcome(
        mean_signed_mm=mean_signed_mm, mean_coordinate_mm=700.0, mae_mm=1.0, rmse_mm=rmse_mm, p95_mm=1.0,
        max_mm=1.0, further_rmse=(), epochs=9, goal_reached=True, seconds=1.0,
    )  # fmt: skip


def test_a_division_by_the_right_length_gives_the_row(board: BoardProblem) -> None:
    """Row 21 prints 0.015; errors of 0.3 to 0.5 mm are that in inches (25.4 mm), whatever their sign."""
    row = row_named("21")
    quotients = quotient_rows({row: [trained(-0.3, 0.1), trained(0.5, 0.1), trained(0.38, 0.1)]})
    signed = next(one for one in quotients if one.figure == FigureReading.MEAN_SIGNED)
    assert signed.quotient_mm == pytest.approx(0.38 / 0.015)
    assert signed.quotient_range_mm == pytest.approx((20.0, 0.5 / 0.015))
    found = divisor_results(quotients, [row], {row.data: board})
    assert [one.divisor for one in found] == list(DIVISORS)
    assert [one.divisor for one in found if one.mean_signed_rows] == ["inch"]
    assert not any(one.coordinate_rows for one in found)
    pixel = next(one for one in found if one.divisor == "a pixel on the board")
    assert pixel.least_mm == pixel.greatest_mm == board.pixel_mm
