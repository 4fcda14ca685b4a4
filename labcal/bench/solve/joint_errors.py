"""Tests of many errors of calibrations at once: of all parameters together, and of the worst one."""

from scipy.stats import chi2, norm, t

_RARE = 0.005
"""Share of good benches in which one such test fails by chance."""
_WITHIN_THREE = 1.0 - 2.0 * float(norm.sf(3.0))
"""Share of normal errors within three standard deviations."""


def most_mean_square(parameters: int) -> float:
    """Return the most that a mean of so many squared normalised errors is, but for chance.

    Parameters
    ----------
    parameters : int
        Of all sets together. Their sum, a squared Mahalanobis distance, has a chi-square distribution
        (Mahalanobis 1936).
    """
    return float(chi2.ppf(1.0 - _RARE, parameters) / parameters)


def most_sigmas(parameters: int) -> float:
    """Return the most standard deviations by which the worst of so many parameters is off, but for chance.

    Errors that hang together have smaller maxima, never larger ones (Sidak 1967), so that this holds for all.
    """
    return _two_sided((1.0 - _RARE) ** (1.0 / parameters))


def median_sigmas(parameters: int) -> float:
    """Return the median of the largest of so many independent normal errors, in standard deviations."""
    return _two_sided(0.5 ** (1.0 / parameters))


def within_three_sigmas(mean_square: float, parameters: int) -> bool:
    """Tell whether all parameters of a set together are as near as one is within three standard deviations.

    Parameters
    ----------
    mean_square : float
        Of a set: its squared Mahalanobis distance, a parameter.
    parameters : int
        Of the set.
    """
    return bool(mean_square * parameters <= chi2.ppf(_WITHIN_THREE, parameters))


def chance_of_mean(sets: int) -> float:
    """Return how many of its standard errors a mean over so many sets is off, but for chance.

    The standard error is of the same few sets, so that the distribution is Student's.
    """
    return float(t.ppf(1.0 - _RARE, sets - 1))


def _two_sided(within: float) -> float:
    """Return the distance within which a share of normal errors lies, in standard deviations."""
    return float(norm.ppf(0.5 + 0.5 * within))
