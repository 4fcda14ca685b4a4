import numpy as np
import pytest
from scipy.stats import binom

from labcal.evaluate.statistics import coverage, error_statistics


def test_figures_of_a_worked_example() -> None:
    true = np.zeros((4, 3))
    predicted = np.array([[3.0, 4, 0], [0, 0, -1], [0, 0, 0], [np.nan, 0, 0]])
    found = error_statistics(predicted, true)
    assert found.n == 3
    np.testing.assert_allclose(found.mean_signed_mm, [1, 4 / 3, -1 / 3])
    assert found.mae_mm == pytest.approx(2)
    assert found.rmse_mm == pytest.approx(np.sqrt(26 / 3))
    assert found.max_mm == 5
    assert found.p95_mm == pytest.approx(4.6)  # 0, 1, 5: nine tenths of the way from 1 to 5


def test_nothing_has_no_figures() -> None:
    found = error_statistics(np.full((3, 3), np.nan), np.zeros((3, 3)))
    assert found.n == 0
    assert np.isnan([*found.mean_signed_mm, found.mae_mm, found.rmse_mm, found.p95_mm, found.max_mm]).all()


def drawn(n: int, scale: float) -> tuple[np.ndarray, np.ndarray]:
    """Return errors with covariances of their own, and these times `scale`."""
    rng = np.random.default_rng(5)
    root = rng.normal(size=(n, 3, 3)) + np.eye(3)
    return (root @ rng.normal(size=(n, 3, 1)))[..., 0], scale * root @ np.swapaxes(root, 1, 2)


def test_an_honest_covariance_covers_95_percent() -> None:
    n = 4000
    low, high = binom.ppf([1e-5, 1 - 1e-5], n, 0.95) / n
    assert low < coverage(*drawn(n, 1.0)) < high
    assert coverage(*drawn(n, 0.5)) < low  # too proud
    assert coverage(*drawn(n, 2.0)) > high  # too modest


def test_what_states_no_covariance_is_not_counted() -> None:
    error = np.array([[0.1, 0, 0], [9.0, 0, 0], [9.0, 0, 0], [np.nan, 0, 0]])
    covariance = np.tile(np.eye(3), (4, 1, 1))
    covariance[1] = np.nan
    covariance[2] = 0.0
    assert coverage(error, covariance) == 1.0
    assert np.isnan(coverage(error[1:], covariance[1:]))
