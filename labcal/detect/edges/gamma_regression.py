"""Gamma regression of the power of noise on the squared wave number, compiled."""

from math import exp, log

import numpy as np

from labcal.detect.compiled import compiled

_ROUNDS = 20
"""It settles in a few."""


@compiled
def gamma_regression(
    square: np.ndarray, ratio: np.ndarray, weight: np.ndarray
) -> tuple[float, float, float, float]:
    """Return level and slope of the logarithm of ratios over squared wave numbers, and variances of both.

    By Fisher's scoring (McCullagh and Nelder 1989, chapter 8). A ratio has two degrees of freedom a dot: its
    relative variance is one over its weight.

    Parameters
    ----------
    square : ndarray, shape (k,)
        Not all alike.
    ratio, weight : ndarray, shape (k,)
        Greater than 0.
    """
    total = weight.sum()
    mean = (weight * square).sum() / total
    away = square - mean
    spread = (weight * away * away).sum()
    level, slope = 0.0, 0.0  # level at the mean
    for number in range(_ROUNDS):
        up, along = 0.0, 0.0
        for k in range(len(ratio)):
            excess = ratio[k] / exp(level + slope * away[k]) - 1.0 if number > 0 else log(ratio[k])
            up += weight[k] * excess
            along += weight[k] * excess * away[k]
        up, along, most = up / total, along / spread, 1.0
        for k in range(len(ratio)):
            most = max(most, abs(up + along * away[k]))
        if number == 0:
            most = 1.0  # the logarithm's own line, to begin with
        level, slope = level + up / most, slope + along / most
    return level - slope * mean, slope, 1.0 / total + mean * mean / spread, 1.0 / spread
