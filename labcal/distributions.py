"""Quantiles and tails of chi-squared, F and beta distributions, without the time that scipy.stats takes.

The bits are those of :mod:`scipy.stats`, which calls the same special functions after building a hundred and
forty distributions.
"""

from scipy.special import betaincc, chdtrc, chdtri, fdtrc, gammaincinv


def chi2_quantile(share: float, freedom: int) -> float:
    """Return the value that a sum of so many squared normal deviates stays below with this probability."""
    return 2.0 * float(gammaincinv(freedom / 2, share))


def chi2_upper_quantile(chance: float, freedom: int) -> float:
    """Return the value that a sum of so many squared normal deviates exceeds with this probability."""
    return float(chdtri(freedom, chance))


def chi2_upper(value: float, freedom: int) -> float:
    """Return how likely a sum of so many squared normal deviates exceeds a value."""
    return float(chdtrc(freedom, value))


def f_tail(ratio: float, upper_freedom: int, lower_freedom: float) -> float:
    """Return how likely a ratio of mean squares exceeds `ratio`; of less than nothing 1, of NaN NaN."""
    return 1.0 if ratio <= 0.0 else float(fdtrc(upper_freedom, lower_freedom, ratio))


def beta_tail(share: float, a: float, b: float) -> float:
    """Return how likely a share that follows a beta distribution exceeds `share`; of NaN NaN."""
    if share <= 0.0 or share >= 1.0:
        return float(share <= 0.0)
    return float(betaincc(a, b, share))
