"""The scatter of RMS errors from one calibration to the next."""

import numpy as np
import pytest
from scipy.stats import chi2

from labcal.guide.rehearsal.confirmation import FoundError, group_rank, lowest_rank
from labcal.guide.rehearsal.error_scatter import ErrorScatter, root_of
from labcal.rng import generator

UNEQUAL = ErrorScatter(1.0, np.array([3.0, 1.0, 0.5, 0.0]))


def test_equal_shares_have_the_quantiles_of_chi_square() -> None:
    scatter = ErrorScatter(0.0, np.full(4, 0.25))
    assert scatter.rms_mm == pytest.approx(1.0)
    low, high = (np.sqrt(chi2.ppf(at, 4) / 4) for at in (0.025, 0.975))
    np.testing.assert_allclose(scatter.range_of_mean(1), (low, high))  # exact here
    np.testing.assert_allclose(scatter.range_mm, (low, high), rtol=0.06)  # by draws
    assert scatter.median_mm == pytest.approx(np.sqrt(chi2.ppf(0.5, 4) / 4), rel=0.02)
    assert scatter.relative_sigma == pytest.approx(np.sqrt(2.0 / 4.0))


@pytest.mark.parametrize("scatter", [UNEQUAL, ErrorScatter(0.1, np.array([1.0, 0.02]))])
def test_so_many_sets_are_within_15_percent_in_95_of_100(scatter: ErrorScatter) -> None:
    random, runs, sets = generator(0, "scatter"), 3000, scatter.sets_needed
    normal = random.standard_normal((runs, sets, len(scatter.shares)))
    mean = scatter.noise_mm2 + (normal**2 @ scatter.shares).mean(axis=1)
    off = np.abs(np.sqrt(mean) / scatter.rms_mm - 1.0)
    share = float((off <= 0.15).mean())
    assert share == pytest.approx(0.95, abs=0.02)
    low, high = scatter.range_of_mean(sets - 2)
    assert low < 0.85 * scatter.rms_mm or high > 1.15 * scatter.rms_mm


def test_errors_that_do_not_scatter_need_one_set() -> None:
    still = ErrorScatter(4.0, np.zeros(3))
    assert still.sets_needed == 1
    assert still.range_mm == still.range_of_mean(5) == (2.0, 2.0)


def test_an_error_holds_within_15_percent_or_within_chance() -> None:
    def found(rms_mm: float, scatter: ErrorScatter) -> FoundError:
        return FoundError.of(np.full((1, 6), rms_mm**2), scatter)

    still = ErrorScatter(1.0, np.zeros(1))
    assert [found(value, still).holds for value in (0.8, 0.9, 1.1, 1.2)] == [False, True, True, False]
    assert found(0.7 * UNEQUAL.rms_mm, UNEQUAL).holds
    assert found(1.1, still).ratio == pytest.approx(1.1)
    assert found(2.0, still).by_set_mm == (2.0,)


def test_the_map_is_compared_in_groups_of_points() -> None:
    expected = np.linspace(1.0, 3.0, 2000)
    normal = generator(1, "map").standard_normal((1, 2000, 3))
    square = (expected[:, None] / 3.0 * normal**2).sum(axis=2)
    assert group_rank(square, expected) > 0.9
    square[0, ::7] = np.nan
    assert group_rank(square, expected) > 0.9
    assert group_rank(square, expected[::-1]) < -0.9


def test_a_map_that_is_nearly_flat_has_a_low_rank_by_chance() -> None:
    steep, flat = (np.linspace(1.0, most, 1000)[:, None, None] * np.eye(3) for most in (4.0, 1.1))
    assert lowest_rank(steep, 1) > 0.9
    assert lowest_rank(flat, 1) < 0.5
    assert lowest_rank(flat, 1) < lowest_rank(flat, 40) < lowest_rank(steep, 1)


def test_a_root_of_a_covariance_gives_it_back() -> None:
    units = np.array([1e-6, 1.0, 1e4])
    half = units[:, None] * generator(2, "root").standard_normal((3, 2))  # of rank two
    covariance = half @ half.T
    root = root_of(covariance)
    np.testing.assert_allclose(root @ root.T / np.outer(units, units), covariance / np.outer(units, units),
                               atol=1e-12)  # fmt: skip
    assert np.array_equal(root_of(np.zeros((2, 2))), np.zeros((2, 2)))
