"""Slopes of the light at a board's dots, from the levels of the dots around them, compiled."""

from math import log
from typing import NamedTuple

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.nearest_planes import nearest_planes


class AroundLimits(NamedTuple):
    """Limits of the levels of the dots around, within which they tell the slope of the light."""

    neighbours: int
    """Dots of a plane."""
    fewest: int
    """Dots of a board, with less of which each has its own slope."""
    most_oblong: float
    most_added: float
    """Variance that a slope may add to a centre, over the centre's."""
    darkest: float
    """Level, grey values."""


@compiled
def slopes_around(
    ok: np.ndarray,
    levels: tuple[np.ndarray, np.ndarray],
    centre: np.ndarray,
    spread: tuple[np.ndarray, np.ndarray],
    own: np.ndarray,
    limits: AroundLimits,
) -> np.ndarray:
    """Return the slopes of the light (n, 2), 1/px, see :func:`labcal.detect.light_fall.in_falling_light`.

    Parameters
    ----------
    ok : ndarray of bool, shape (n,)
        Dots that are fitted.
    levels : tuple of ndarray
        Of board and dot, shape (n,), grey values above no light.
    centre : ndarray, shape (n, 2)
        px.
    spread : tuple of ndarray
        Blur, shape (n,), px, and the centres' covariance, shape (n, 2, 2).
    own : ndarray, shape (n, 2)
        Slope of the own board's level, 1/px.
    limits : AroundLimits
    """
    board, dot = levels
    blur, covariance = spread
    slopes, some = np.zeros((len(ok), 2)), np.flatnonzero(ok)
    for k in range(len(ok)):
        if not ok[k] or board[k] > dot[k]:
            slopes[k] = own[k]
    if len(some) < limits.fewest:
        return slopes
    place, level = centre[some], np.empty(len(some))
    for j in range(len(some)):
        level[j] = log(max(board[some[j]], dot[some[j]], limits.darkest))
    around, variance = nearest_planes(place, level, min(limits.neighbours, len(some)), limits.most_oblong)
    for j in range(len(some)):
        k = some[j]
        if blur[k] ** 4 * variance[j] < limits.most_added * (covariance[k, 0, 0] + covariance[k, 1, 1]):
            slopes[k] = around[j]
    return slopes
