"""The rows of the paper that come out as printed: its errors of zero, in about its epochs."""

from statistics import median

import pytest

from labcal.paper.rows import row_named
from labcal.paper.simulated import NoiseReading
from labcal.paper.training_run import TrainingRun, run_training

SEEDS = range(5)
LIMIT_MM = 0.1


@pytest.mark.parametrize("exp", ["01", "02", "08", "09", "13", "15"])
def test_the_error_is_none_in_about_the_papers_epochs(exp: str) -> None:
    row = row_named(exp)
    outcomes = [run_training(TrainingRun(row, "mlp", NoiseReading.NONE, "", None, s, 200)) for s in SEEDS]
    assert all(outcome.goal_reached for outcome in outcomes)
    assert abs(median(outcome.mean_signed_mm for outcome in outcomes)) <= LIMIT_MM
    assert row.paper_epochs is not None
    epochs = median(outcome.epochs or 0 for outcome in outcomes)
    assert row.paper_epochs / 2 <= epochs <= row.paper_epochs * 2
