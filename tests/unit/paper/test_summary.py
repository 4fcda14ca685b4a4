from dataclasses import replace

import pytest

from labcal.paper.rows import row_named
from labcal.paper.simulated import NoiseReading
from labcal.paper.summary import figures_of, least_squares_readings, row_result
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


def test_ranges_are_those_of_the_seeds() -> None:
    runs = [outcome(rmse_mm=r, epochs=e, max_mm=2 * r) for r, e in ((1.0, 9), (5.0, 3), (2.0, 30))]
    figures = figures_of("mlp", runs)
    assert (figures.rmse_range_mm, figures.max_range_mm, figures.epochs_range) == ((1, 5), (2, 10), (3, 30))
    assert figures_of("dlt", [outcome(epochs=None, goal_reached=None)]).epochs_range is None


def test_the_reading_nearest_over_all_rows() -> None:
    """Row 10 prints 11.69 mm and row 05 -6.78 mm; a reading of both is judged by the mean of its decades."""
    rows = []
    for exp, figures in (
        ("10", {"affine": 116.9, "dlt": 11.69}),
        ("05", {"affine": -6.78, "homography": 0.678}),
    ):
        readings = [figures_of(name, [outcome(mean_signed_mm=s)]) for name, s in figures.items()]
        beside = [figures_of(f"affine, noise {NoiseReading.PIXEL}", [outcome(mean_signed_mm=1e-3)])]
        rows.append(row_result(row_named(exp), readings, beside, 1))
    found = {one.reading: one for one in least_squares_readings(rows)}
    assert found["affine"].decades == pytest.approx(0.5)
    assert found["affine"].rows == ("10", "05")
    assert found["homography or dlt"].decades == pytest.approx(0.5)
    assert list(found) == ["affine", "homography or dlt"]
    assert least_squares_readings([]) == ()


def test_the_network_is_named_with_its_outputs() -> None:
    row = replace(row_named("23"), hidden=(55,))
    assert row_result(row, [figures_of("mlp", [OUTCOME])], [], 1).network == "55-4"
