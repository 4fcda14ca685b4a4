"""Gamma regression of noise on the squared wave number."""

import numpy as np

from labcal.detect.edges.gamma_regression import gamma_regression
from labcal.rng import generator

SQUARE = np.array([0.002, 0.006, 0.01, 0.016, 0.03, 0.04])


def test_ratios_on_a_line_are_met_exactly() -> None:
    ratio = np.exp(0.3 - 20.0 * SQUARE)
    level, slope, _, _ = gamma_regression(SQUARE, ratio, np.array([5.0, 9.0, 3.0, 7.0, 2.0, 8.0]))
    np.testing.assert_allclose([level, slope], [0.3, -20.0], rtol=1e-12)


def test_estimates_scatter_as_their_variances_say() -> None:
    random = generator(0, "test", "gamma regression")
    weight = np.full(6, 150.0)
    normalised = []
    for _ in range(400):
        ratio = np.exp(0.3 - 20.0 * SQUARE) * random.gamma(weight) / weight
        level, slope, level_variance, slope_variance = gamma_regression(SQUARE, ratio, weight)
        normalised.append([(level - 0.3) / level_variance**0.5, (slope + 20.0) / slope_variance**0.5])
    errors = np.array(normalised)
    # Chi-square with 400 degrees of freedom, by its normal approximation; the mean by a z test.
    z_spread = ((errors**2).sum(axis=0) - 400.0) / np.sqrt(800.0)
    z_mean = errors.mean(axis=0) * 20.0
    assert (np.abs(z_spread) < 3.5).all()
    assert (np.abs(z_mean) < 3.5).all()
