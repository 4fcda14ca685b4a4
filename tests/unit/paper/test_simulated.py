import numpy as np
import pytest

from labcal.paper.rows import ROWS, Data, PaperRow, row_named
from labcal.paper.simulated import (
    FOCAL_LENGTH_MM,
    FOCAL_RATIO,
    LOOK_AT_MM,
    PIXEL_MM,
    TESTS,
    NoiseReading,
    cameras,
    simulate,
)

SIMULATED = [row for row in ROWS if not row.pictured]
HEIGHTS = {Data.PLANE: (200, 200), Data.FOCAL_LENGTHS: (200, 200), Data.OTHER_PLANE: (500, 500)}


@pytest.mark.parametrize("row", SIMULATED, ids=lambda row: row.exp)
def test_data_are_as_the_row_asks(row: PaperRow) -> None:
    problem = simulate(row, NoiseReading.NONE, 0)
    outputs = 5 if row.data is Data.FOCAL_LENGTHS else 3
    assert problem.X.shape == (row.points, 4)
    assert problem.Y.shape == (row.points, outputs)
    assert problem.Y_test.shape == (TESTS, outputs)
    low, high = HEIGHTS.get(row.data, (0, 1000))
    for Y in (problem.Y, problem.Y_test):
        assert Y[:, :2].min() >= 650
        assert Y[:, :2].max() <= 1350
        assert Y[:, 2].min() >= low
        assert Y[:, 2].max() <= high
    assert np.isfinite(problem.X).all()
    assert np.isfinite(problem.X_test).all()
    trained = {tuple(p) for p in problem.Y.tolist()}
    assert len(trained) == row.points
    assert not trained & {tuple(p) for p in problem.Y_test.tolist()}


@pytest.mark.parametrize(
    ("exp", "counts"),
    [
        ("01", (20, 15, 1)),
        ("03", (25, 10, 1)),
        ("05", (15, 10, 1)),
        ("11", (10, 5, 4)),
        ("12", (10, 10, 3)),
        ("14", (5, 5, 4)),
    ],
)
def test_grids_have_the_counts_that_the_reading_fixes(exp: str, counts: tuple[int, ...]) -> None:
    Y = simulate(row_named(exp), NoiseReading.NONE, 0).Y
    assert tuple(len(np.unique(column)) for column in Y.T) == counts


def test_image_coordinates_are_those_of_the_cameras() -> None:
    problem = simulate(row_named("15"), NoiseReading.NONE, 0)
    left, right = cameras(FOCAL_LENGTH_MM)
    np.testing.assert_array_equal(problem.X[:, :2], left.project(problem.Y)[0])
    np.testing.assert_array_equal(problem.X[:, 2:], right.project(problem.Y)[0])
    for camera in (left, right):
        image, ok = camera.project(np.array([LOOK_AT_MM]))
        assert ok.all()
        np.testing.assert_allclose(image, 0, atol=1e-9)


def test_the_second_model_of_camera_has_the_longer_lens() -> None:
    problem = simulate(row_named("06"), NoiseReading.NONE, 0)
    focal = problem.Y[:, 3:]
    assert np.unique(focal).tolist() == pytest.approx([FOCAL_LENGTH_MM, FOCAL_RATIO * FOCAL_LENGTH_MM])
    assert (focal[:, 0] == focal[:, 1]).all()
    longer = focal[:, 0] > FOCAL_LENGTH_MM
    assert longer.sum() == 100
    left, _ = cameras(FOCAL_RATIO * FOCAL_LENGTH_MM)
    np.testing.assert_array_equal(problem.X[longer, :2], left.project(problem.Y[longer, :3])[0])


@pytest.mark.parametrize("reading", [NoiseReading.SPREAD, NoiseReading.PIXEL])
def test_noise_has_the_size_that_its_reading_says(reading: NoiseReading) -> None:
    row = row_named("03")
    exact, noisy = simulate(row, NoiseReading.NONE, 3), simulate(row, reading, 3)
    np.testing.assert_array_equal(noisy.Y, exact.Y)
    sigma = 0.05 * exact.X.std(axis=0) if reading is NoiseReading.SPREAD else np.full(4, 0.05 * PIXEL_MM)
    pair = cameras(FOCAL_LENGTH_MM)
    exact_test = np.hstack([camera.project(noisy.Y_test)[0] for camera in pair])
    for noise in (noisy.X - exact.X, noisy.X_test - exact_test):
        # The variance over its expectation has a standard deviation of sqrt(2 / n).
        ratio = (noise**2).mean(axis=0) / sigma**2
        assert (np.abs(ratio - 1) < 4 * np.sqrt(2 / len(noise))).all()


def test_a_seed_gives_the_same_data_and_another_gives_others() -> None:
    row = row_named("13")
    once, again, other = (simulate(row, NoiseReading.SPREAD, seed) for seed in (0, 0, 1))
    np.testing.assert_array_equal(once.X, again.X)
    np.testing.assert_array_equal(once.X_test, again.X_test)
    assert (once.Y != other.Y).any()
