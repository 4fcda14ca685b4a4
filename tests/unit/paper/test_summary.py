from dataclasses import replace

import pytest

from labcal.paper.rows import row_named
from labcal.paper.summary import figures_of, row_result
from labcal.paper.training_run import TrainingOutcome

OUTCOME = TrainingOutcome(
    mean_signed_mm=0.05, mean_coordinate_mm=800.0, mae_mm=1.0, rmse_mm=2.0, p95_mm=3.0, max_mm=4.0,
    further_rmse=(0.5,), epochs=9, goal_reached=True, seconds=1.0,
)  # fmt: skip


def outcome(**changes: float) -> TrainingOutcome:
    return OUTCOME.model_copy(update=changes)


def test_figures_are_medians_over_the_seeds() -> None:
    runs = [outcome(mean_signed_mm=s, rmse_mm=r) for s, r in ((-3.0, 1.0), (1.0, 5.0), (2.0, 2.0))]
    figures = figures_of("mlp", runs)
    assert figures.mean_signed_m == pytest.approx(0.001)
    assert figures.rel == pytest.approx(1.0 / 800.0)
    assert figures.mean_signed_range_m == pytest.approx((-0.003, 0.002))
    assert (figures.rmse_mm, figures.epochs, figures.goal_reached) == (2.0, 9, True)
    assert figures.further_rmse == (0.5,)


def test_least_squares_takes_the_reading_nearest_to_the_paper() -> None:
    row = row_named("10")  # the paper: +11.69 mm
    readings = [figures_of(name, [outcome(mean_signed_mm=s)]) for name, s in (("a", -11.0), ("b", 10.0))]
    beside = [figures_of("c", [outcome(mean_signed_mm=11.69)])]
    result = row_result(row, readings, beside, 1)
    assert result.reading == "b"
    assert [figures.reading for figures in result.readings] == ["a", "b", "c"]


@pytest.mark.parametrize(
    ("exp", "mean_signed_mm", "epochs", "verdict"),
    [
        ("08", 0.19, 9, "reproduced"),
        ("08", 0.21, 9, "not reproduced"),
        ("08", -0.21, 9, "not reproduced"),
        ("08", 0.0, 18, "reproduced"),
        ("08", 0.0, 19, "reproduced in other epochs"),
        ("08", 0.0, 4, "reproduced in other epochs"),
        ("07", 0.0, 7, "paper contradicts itself"),
    ],
)
def test_verdicts(exp: str, mean_signed_mm: float, epochs: int, verdict: str) -> None:
    figures = figures_of("mlp", [outcome(mean_signed_mm=mean_signed_mm, epochs=epochs)])
    assert row_result(row_named(exp), [figures], [], 1).verdict == verdict


def test_the_network_is_named_with_its_outputs() -> None:
    row = replace(row_named("23"), hidden=(55,))
    assert row_result(row, [figures_of("mlp", [OUTCOME])], [], 1).network == "55-4"
