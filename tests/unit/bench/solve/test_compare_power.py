"""The theoretical power of a comparison, against the noncentral chi-square distribution and drawn errors."""

import numpy as np
import pytest
from scipy.stats import chi2, ncx2

from labcal.bench.solve.compare_power import power
from labcal.evaluate.comparison.without_motion import RemainingDifference, Uncertain
from labcal.rng import generator

N = 5


def remaining(difference: np.ndarray, variance: float) -> RemainingDifference:
    """Return differences whose coordinates have this variance each, half of it by either calibration."""
    by = np.eye(3 * N).reshape(N, 3, 3 * N)
    half = Uncertain(by, 0.5 * variance * np.eye(3 * N))
    weight = np.tile(np.eye(3) / variance, (N, 1, 1))
    return RemainingDifference(difference, half, half, weight, np.ones(N, dtype=bool))


@pytest.mark.parametrize("size", [0.0, 2.0, 4.0])
def test_of_independent_differences_it_is_that_of_chi_square(size: float) -> None:
    before = remaining(np.ones((N, 3)), 0.04)
    after = remaining(np.ones((N, 3)) + 0.2 * size / np.sqrt(3 * N), 0.04)
    expected = ncx2.sf(chi2.isf(0.01, 3 * N), 3 * N, size**2) if size else 0.01
    spread = np.sqrt(expected * (1.0 - expected) / 20_000)
    assert power(before, after, 0.01, generator(3, "power")) == pytest.approx(expected, abs=4.0 * spread)


def test_without_covariances_there_is_none() -> None:
    difference = np.zeros((N, 3))
    unknown = RemainingDifference(
        difference, None, None, np.tile(np.eye(3), (N, 1, 1)), np.ones(N, dtype=bool)
    )
    assert np.isnan(power(unknown, unknown, 0.01, generator(3, "power")))
