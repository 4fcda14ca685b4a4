"""Crosses of saddle points: each one's next ones along both of its edges, in compiled code."""

from math import atan2, hypot, log, pi
from typing import NamedTuple

import numpy as np

from labcal.detect.compiled import compiled

_ARMS = ((1, 0.0), (1, pi), (0, 0.0), (0, pi))
"""Edge, and turn from it. The second edge's angle is the larger one, and y runs down: turned anticlockwise
it gives the first."""


_PARALLEL = 1.5
"""Most angle between the edges of neighbours, of that from an edge to the next corner on it."""


class CrossLimits(NamedTuple):
    """The settings of saddle points that crosses take."""

    max_step_factor: float
    max_bend_deg: float


@compiled
def saddle_crosses(
    saddles: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray],
    near: np.ndarray,
    limits: CrossLimits,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the next corners along both edges, (n, 4), and their misfit; infinite where one is missing.

    Parameters
    ----------
    saddles : tuple of ndarray
        Places (n, 2), angles of the edges (n, 2), whether it is white between these (n,), and steps (n,), as
        :class:`labcal.detect.corners.saddles.Saddles` has them.
    near : ndarray of int, shape (n, k)
        Numbers of the saddle points around each, the nearest first.
    limits : CrossLimits
    """
    place, edges, white_between, step = saddles
    n = len(place)
    arms, misfit, lengths = np.zeros((n, 4), dtype=np.int64), np.full(n, np.inf), np.empty(4)
    most, factor = limits.max_bend_deg * pi / 180.0, log(limits.max_step_factor)
    parallel = _PARALLEL * most
    for i in range(n):
        lengths[:] = np.inf
        arms[i] = near[i, 0]
        bisector = 0.5 * (edges[i, 0] + edges[i, 1])
        own = _is_white(edges, white_between, i, bisector)
        for k in near[i]:
            alike = _is_white(edges, white_between, k, bisector) == own
            if alike or not abs(log(step[k] / step[i])) < factor or _turned(edges, i, k) > parallel:
                continue
            x, y = place[k, 0] - place[i, 0], place[k, 1] - place[i, 1]
            angle, length = atan2(y, x), hypot(x, y)
            for arm, (edge, turn) in enumerate(_ARMS):
                off = abs((angle - edges[i, edge] - turn + pi) % (2.0 * pi) - pi)
                if off < most and length < lengths[arm]:
                    arms[i, arm], lengths[arm] = k, length
        if lengths.max() < np.inf:
            misfit[i] = _misfit(place, i, (arms[i], lengths), limits.max_step_factor)
    return arms, misfit


@compiled
def _turned(edges: np.ndarray, i: int, k: int) -> float:
    """Return by how much the edges of one saddle point are turned against those of another, at most (rad)."""
    first, second, half = edges[i, 0] - edges[k, 0], edges[i, 1] - edges[k, 1], 0.5 * pi
    straight = max(abs((first + half) % pi - half), abs((second + half) % pi - half))
    first, second = edges[i, 0] - edges[k, 1], edges[i, 1] - edges[k, 0]
    crossed = max(abs((first + half) % pi - half), abs((second + half) % pi - half))
    turned: float = min(straight, crossed)
    return turned


@compiled
def _is_white(edges: np.ndarray, white_between: np.ndarray, k: int, angle: float) -> bool:
    """Tell whether it is white beside one of the saddle points in a direction (rad)."""
    is_white: bool = (edges[k, 0] < angle % pi < edges[k, 1]) == white_between[k]
    return is_white


@compiled
def _misfit(place: np.ndarray, i: int, arms: tuple[np.ndarray, np.ndarray], factor: float) -> float:
    """Return how far a corner is from the middle of opposite ones, over their distance; else infinite."""
    which, lengths = arms
    worst = 0.0
    for k in (0, 2):
        shorter, longer = min(lengths[k], lengths[k + 1]), max(lengths[k], lengths[k + 1])
        if not longer < factor * shorter:
            return np.inf
        x = place[which[k], 0] + place[which[k + 1], 0] - 2.0 * place[i, 0]
        y = place[which[k], 1] + place[which[k + 1], 1] - 2.0 * place[i, 1]
        worst = max(worst, hypot(x, y) / (lengths[k] + lengths[k + 1]))
    return worst
