"""Rank statistics on data with a known answer."""

import itertools

import numpy as np
import pytest
from scipy.stats import binom, wilcoxon

from labcal.errors import InputError
from labcal.paper.claims.statistics import hodges_lehmann, holm, one_sided_p
from labcal.rng import generator


def test_p_values_are_those_of_all_assignments_of_signs() -> None:
    d = np.array([0.3, -0.1, 0.7, 1.1, 0.9, -0.2, 1.3])
    ranks = np.argsort(np.argsort(np.abs(d))) + 1
    observed = ranks[d > 0].sum()
    sums = [ranks[np.array(signs)].sum() for signs in itertools.product([False, True], repeat=len(d))]
    assert one_sided_p(d, "greater", 0.0) == pytest.approx(np.mean(np.array(sums) >= observed), rel=1e-12)
    assert one_sided_p(d, "less", 0.0) == pytest.approx(np.mean(np.array(sums) <= observed), rel=1e-12)


def test_p_of_tied_and_zero_differences_is_exact() -> None:
    d = np.array([0.0, 0.0, 0.5, 0.5, 0.5, -0.5, 1.0])
    ranks = np.array([0.0, 0.0, 4.5, 4.5, 4.5, 4.5, 7.0])  # Pratt: zeros take ranks, and count nothing
    observed = ranks[d > 0].sum()
    sums = [ranks[np.array(signs)].sum() for signs in itertools.product([False, True], repeat=len(d))]
    assert one_sided_p(d, "greater", 0.0) == pytest.approx(np.mean(np.array(sums) >= observed), rel=1e-12)


def test_equal_arms_are_no_evidence() -> None:
    assert one_sided_p(np.zeros(12), "greater", 0.0) == 1.0
    assert one_sided_p(np.zeros(12), "less", 0.1) == pytest.approx(2.0**-12)


@pytest.mark.parametrize("n", [6, 10, 17])
def test_the_interval_holds_what_the_test_does_not_reject(n: int) -> None:
    d = generator(n, "test interval").normal(0.3, 1.0, n)
    found = hodges_lehmann(d)
    for end, inwards in ((found.low, 1e-9), (found.high, -1e-9)):
        assert wilcoxon(d - (end + inwards), method="exact").pvalue > 0.05
        assert wilcoxon(d - (end - inwards), method="exact").pvalue <= 0.05
    means = [(a + b) / 2 for a, b in itertools.combinations_with_replacement(d, 2)]
    assert found.estimate == pytest.approx(np.median(means), rel=1e-12)


def test_five_pairs_have_no_interval_at_95_percent() -> None:
    assert np.isinf(hodges_lehmann(np.arange(1.0, 6.0)).low)
    assert np.isfinite(hodges_lehmann(np.arange(1.0, 7.0)).low)


def test_holm_against_its_published_rule() -> None:
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([0.9, 0.8]) == [1.0, 1.0]


@pytest.mark.parametrize("draw", ["normal", "laplace", "uniform"])
def test_intervals_cover_the_centre_as_often_as_they_say(draw: str) -> None:
    """1,000 experiments of ten correlated pairs; exact levels are a little above 95%."""
    random = generator(1, "test coverage", draw)
    kept = 0
    for _ in range(1000):
        common = random.normal(0.0, 5.0, 10)  # what both arms share at a seed
        arms = [common + getattr(random, draw)(size=10) for _ in range(2)]
        found = hodges_lehmann(arms[0] + 0.7 - arms[1])
        kept += found.low <= 0.7 <= found.high
    exact = 1.0 - 2 * 25 / 1024  # of n = 10: 25 subsets have a rank sum of at most 8
    low, high = binom.interval(0.999, 1000, exact)
    assert low <= kept <= high


def test_wrong_differences_are_refused() -> None:
    with pytest.raises(InputError, match="finite"):
        hodges_lehmann([])
    with pytest.raises(InputError, match="finite"):
        one_sided_p([1.0, float("nan")], "less", 0.0)
