"""Exact rank statistics of paired differences: Wilcoxon's test, its interval, and Holm's correction.

Sources: F. Wilcoxon, Biometrics Bulletin 1 (1945) 80; J. L. Hodges and E. L. Lehmann, Ann. Math. Statist.
34 (1963) 598; S. Holm, Scand. J. Statist. 6 (1979) 65; D. J. Schuirmann, J. Pharmacokin. Biopharm. 15 (1987)
657.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from scipy.stats import PermutationMethod, wilcoxon

from labcal.arrays import AnyArray, float_array
from labcal.errors import InputError
from labcal.rng import generator

CONFIDENCE = 0.95
MOST_SIGNS = 2**13
"""Up to so many assignments of signs, p values of tied differences are exact; beyond, signs are drawn."""


@dataclass(frozen=True)
class Interval:
    """A Hodges-Lehmann estimate of the centre of differences, with its confidence interval."""

    estimate: float
    low: float
    high: float
    """Infinite at both ends where there are too few differences for this confidence."""
    confidence: float


def one_sided_p(differences: AnyArray, alternative: Literal["less", "greater"], bound: float) -> float:
    """Return the p value of Wilcoxon's signed-rank test that the centre is below (or above) a bound.

    Exact. Where differences from the bound are zero or tied in size, ranks are shared (zeros by Pratt's
    rule), and the p value is that of all assignments of signs, or of 8192 drawn ones beyond 13 differences.

    Parameters
    ----------
    differences : array_like, shape (n,)
        Paired differences; symmetric about their centre, whatever their distribution.
    alternative : {"less", "greater"}
        The statement for which evidence is sought: the centre is less (greater) than `bound`.
    bound : float

    Raises
    ------
    InputError
        There are no differences, or one is not finite.
    """
    beyond = _finite(differences) - bound
    if not beyond.any():
        return 1.0
    sizes = np.abs(beyond)
    if sizes.all() and len(np.unique(sizes)) == len(sizes):
        return float(wilcoxon(beyond, alternative=alternative, method="exact").pvalue)
    signs = PermutationMethod(n_resamples=MOST_SIGNS, rng=generator(0, "signed ranks"))
    return float(wilcoxon(beyond, alternative=alternative, zero_method="pratt", method=signs).pvalue)


def hodges_lehmann(differences: AnyArray, confidence: float = CONFIDENCE) -> Interval:
    """Return the median of all pairwise means (Walsh averages), with the interval that Wilcoxon's test gives.

    A value lies within the interval if the exact two-sided test at ``1 - confidence`` does not reject it.

    Parameters
    ----------
    differences : array_like, shape (n,)
    confidence : float

    Raises
    ------
    InputError
        There are no differences, or one is not finite.
    """
    d = _finite(differences)
    i, j = np.triu_indices(len(d))
    walsh = np.sort((d[i] + d[j]) / 2)
    left_out = _left_out(len(d), (1 - confidence) / 2)
    low, high = -np.inf, np.inf
    if left_out is not None:
        low, high = walsh[left_out], walsh[len(walsh) - 1 - left_out]
    return Interval(float(np.median(walsh)), float(low), float(high), confidence)


def holm(p_values: Sequence[float]) -> list[float]:
    """Return p values adjusted for their number by Holm's step-down rule, in the order given.

    The probability that any of the hypotheses with an adjusted p value of at most 0.05 is rejected wrongly is
    at most 0.05, whatever their dependence.
    """
    adjusted = [0.0] * len(p_values)
    greatest = 0.0
    for step, index in enumerate(sorted(range(len(p_values)), key=lambda i: p_values[i])):
        greatest = max(greatest, min(1.0, (len(p_values) - step) * p_values[index]))
        adjusted[index] = greatest
    return adjusted


@lru_cache
def _left_out(count: int, tail: float) -> int | None:
    """Return how many ordered Walsh averages lie beyond each end of the interval; None if it has no ends.

    The rank sum of n signs is that of a random subset of 1 ... n: its distribution is a product of
    polynomials 1 + x**k.
    """
    ways = np.ones(1)
    for k in range(1, count + 1):
        ways = np.convolve(ways, np.concatenate([[1.0], np.zeros(k - 1), [1.0]])) / 2.0
    at_most = np.cumsum(ways)
    rejected = int(np.searchsorted(at_most, tail * (1 + 1e-12), side="right"))
    return rejected - 1 if rejected else None


def _finite(differences: AnyArray) -> np.ndarray:
    d = float_array(differences, ("n",), "differences")
    if len(d) == 0 or not np.isfinite(d).all():
        raise InputError(f"A paired test needs finite differences, but {d.tolist()} are given.")
    return d
