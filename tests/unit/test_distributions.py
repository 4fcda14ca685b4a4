"""Quantiles and tails have the bits of scipy.stats, at and beyond the ends, too."""

import numpy as np
import pytest
from scipy import stats

from labcal.distributions import beta_tail, chi2_quantile, chi2_upper_quantile, f_tail

ENDS = (-np.inf, -1.0, 0.0, 1e-300, 1.0, 1e300, np.inf, np.nan)


@pytest.mark.parametrize("freedom", [1, 2, 3, 5, 30])
def test_quantiles_of_chi_squared(freedom: int) -> None:
    for chance in (0.0, 1e-6, 0.05, 0.5, 0.95, 1.0):
        assert chi2_quantile(chance, freedom) == stats.chi2.ppf(chance, freedom)
        assert chi2_upper_quantile(chance, freedom) == stats.chi2.isf(chance, freedom)
    assert chi2_quantile(0.5, freedom) == stats.chi2.median(freedom)


def test_the_tail_of_a_ratio_of_variances() -> None:
    for ratio in (*ENDS, 0.3, 2.5, 40.0):
        for lower in (1.0, 2.5, 400.0, np.inf):
            np.testing.assert_array_equal(f_tail(ratio, 6, lower), stats.f.sf(ratio, 6, lower))


def test_the_tail_of_a_share() -> None:
    for share in (*ENDS, 0.01, 0.3, 0.99):
        for a, b in ((0.5, 0.5), (1.5, 4.0), (9.5, 1.0)):
            np.testing.assert_array_equal(beta_tail(share, a, b), stats.beta.sf(share, a, b))
