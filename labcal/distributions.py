"""Quantiles and tails of chi-squared, F and beta distributions, without the time that scipy.stats takes.

The bits are those of :mod:`scipy.stats`, which calls the same special functions after building a hundred and
forty distributions.
"""

from math import isinf

from scipy.special import (
    betaincc,
    chdtrc,
    chdtri,
    chndtrinc,
    fdtrc,
    fdtri,
    gammaincinv,
    ncfdtrinc,
)


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


def gain_tail(gain: float, freedom: int, noise_freedom: float) -> float:
    """Return how likely chance decreases a sum of squares by a gain, with so many parameters more.

    The unit of the squares is known by `noise_freedom` degrees of freedom, which may be infinite.
    """
    if isinf(noise_freedom):
        return float(chdtrc(freedom, gain))
    return f_tail(gain / freedom, freedom, noise_freedom)


def needed_gain(chance: float, freedom: int, noise_freedom: float, power: float) -> float:
    """Return the noncentrality that is found with a probability `power` by a test of level `chance`.

    That of :func:`gain_tail`, where the true change decreases the sum of squares by so much.
    """
    if isinf(noise_freedom):
        return float(chndtrinc(chdtri(freedom, chance), freedom, 1.0 - power))
    critical = fdtri(freedom, noise_freedom, 1.0 - chance)
    return float(ncfdtrinc(freedom, noise_freedom, 1.0 - power, critical))
