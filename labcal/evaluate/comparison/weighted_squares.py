"""The chance of a weighted sum of squared normal deviates."""

import numpy as np
from jaxtyping import Float64
from scipy.optimize import brentq
from scipy.special import ndtr

_NEGLIGIBLE = 1e-12
"""Weights below this part of the largest one."""
_LEAST, _MOST = 1e-12, 1e5
"""Mean squares, in units of the largest weight, below which the chance is 1, and above which it is 0."""
_NEAR_MEAN = 1e-4
"""Distance from the mean, in standard deviations, below which the limit of the formula is taken."""


def weighted_squares_tail(value: float, weights: Float64[np.ndarray, " k"]) -> float:
    """Return how likely a sum of squared standard normal deviates, each times its weight, exceeds a value.

    Parameters
    ----------
    value : float
    weights : ndarray, shape (k,)
        Not negative, as eigenvalues are.

    Returns
    -------
    float
        NaN of NaN; where all weights are zeros 0 of a positive value, else 1.

    Notes
    -----
    Saddlepoint approximation of Lugannani and Rice, by Kuonen 1999, "Saddlepoint approximations for
    distributions of quadratic forms in normal variables", Biometrika 86. Its relative error is some per cent
    at most, far in the tail, too.

    Examples
    --------
    >>> round(weighted_squares_tail(18.307, np.ones(10)), 3)  # chi-squared with 10 degrees of freedom
    0.05
    """
    if not np.isfinite(value):
        return float("nan")
    largest = float(weights.max(initial=0.0))
    if value <= 0.0 or largest <= 0.0:
        return float(value <= 0.0)
    scaled, at = weights[weights > _NEGLIGIBLE * largest] / largest, value / largest
    if not _LEAST < at / len(scaled) < _MOST:
        return float(at < 1.0)
    deviation = float(np.sqrt(2.0 * (scaled**2).sum()))
    if abs(at - scaled.sum()) < _NEAR_MEAN * deviation:  # smooth there: both sides of it, averaged
        step = 2.0 * _NEAR_MEAN * deviation
        return 0.5 * (_tail(at - step, scaled) + _tail(at + step, scaled))
    return _tail(at, scaled)


def _tail(at: float, weights: Float64[np.ndarray, " k"]) -> float:
    """Return the same of weights up to 1, not at the mean."""

    def slope(z: float) -> float:
        return float((weights / (1.0 - 2.0 * z * weights)).sum()) - at

    lowest = -1.0 * len(weights) / at - 1.0  # there the sum is half of `at` at most
    saddle = float(brentq(slope, lowest, 0.5 * (1.0 - 1e-14), xtol=1e-14))
    shrunk = 1.0 - 2.0 * saddle * weights
    w = float(np.sign(saddle) * np.sqrt(max(0.0, 2.0 * saddle * at + np.log(shrunk).sum())))
    v = saddle * float(np.sqrt(2.0 * ((weights / shrunk) ** 2).sum()))
    return float(np.clip(ndtr(-(w + np.log(v / w) / w)), 0.0, 1.0))
