"""Crosses of spots whose arms are square to each other on the board, compiled."""

from math import sqrt
from typing import NamedTuple

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.matrices import geometric_means, inverses, matrix_roots

Spots = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
"""Centres, outline matrices, brightness of the middles, and radii of spots."""


class CrossLimits(NamedTuple):
    """The settings of the grid that seeds take."""

    seed_radius_log: float
    seed_neighbours: int
    min_seed_neighbours: int
    seed_residual_steps: float
    seed_shape_log: float
    seed_cell_factor: float
    ring_hole_share: float


@compiled
def cross_at(
    i: int,
    spots: Spots,
    wanted: tuple[float, float, int],
    limits: CrossLimits,
    steps: np.ndarray,
) -> tuple[np.ndarray, float]:
    """Return the spots of the smallest cross around spot i at its steps, and how badly it fits.

    Parameters
    ----------
    i : int
    spots : tuple of ndarray
        See `Spots`.
    wanted : (float, float, int)
        Logarithm of the ratio of the steps, a ring's radius over a dot's, and how many corners are needed.
    limits : CrossLimits
    steps : ndarray of int, shape (m, 2)
        Steps along both axes, those of the middle first.

    Returns
    -------
    spots : ndarray of int, shape (m,)
        -1 where no spot is; at the middle, too, where there is no cross.
    misfit : float
    """
    nothing = np.full(len(steps), -1)
    near = _around(i, spots, limits)
    if len(near) < max(limits.min_seed_neighbours, 1):
        return nothing, np.inf
    present = _flattened(i, near, spots, wanted[1], limits.ring_hole_share)
    most = limits.seed_residual_steps
    opposite = np.array(
        [_off(present, -present[k, 0], -present[k, 1]) / _length(present[k]) for k in range(len(near))]
    )
    arms = np.flatnonzero(opposite < most)
    if len(arms) < 2:  # noqa: PLR2004 - an arm and its opposite
        return nothing, np.inf
    pairs = _full_crosses(arms, present, opposite, wanted[2])
    first, second, misfit = _smallest(arms, arms, pairs, present, (wanted[0], limits))
    if first < 0:
        every = np.arange(len(near))
        pairs = _half_crosses(arms, present, opposite)
        first, second, misfit = _smallest(arms, every, pairs, present, (wanted[0], limits))
    if first < 0 or _is_coarse(present[first], present[second], present, most):
        return nothing, np.inf
    u, v = present[first], present[second]
    if u[0] * v[1] - u[1] * v[0] > 0.0:  # y is down in the picture and up on the board
        u, v = v, u
    nothing[0] = i
    limit = most * min(_length(u), _length(v))
    for number in range(1, len(steps)):
        a, b = steps[number]
        x, y = a * u[0] + b * v[0], a * u[1] + b * v[1]
        nearest = _nearest(present, x, y)
        if _off(present, x, y) < limit and not (nothing == near[nearest]).any():
            nothing[number] = near[nearest]
    return nothing, misfit


@compiled
def _around(i: int, spots: Spots, limits: CrossLimits) -> np.ndarray:
    """Return the spots nearest to spot i that are about as large."""
    centre, _, _, radius = spots
    alike = np.abs(np.log(radius / radius[i])) < limits.seed_radius_log
    alike[i] = False
    near = np.flatnonzero(alike)
    distance = np.empty(len(near))
    for k in range(len(near)):
        x, y = centre[near[k], 0] - centre[i, 0], centre[near[k], 1] - centre[i, 1]
        distance[k] = sqrt(x * x + y * y)
    return near[np.argsort(distance, kind="mergesort")[: limits.seed_neighbours]]


@compiled
def _flattened(
    i: int, near: np.ndarray, spots: Spots, ring_size: float, ring_hole_share: float
) -> np.ndarray:
    """Return the steps from spot i to those near it, (n, 2), in radii of the dots on the board."""
    centre, shape, hole, _ = spots
    which = np.append(near, i)
    flatten = inverses(matrix_roots(shape[which]))
    for k in range(len(which)):
        if hole[which[k]] > ring_hole_share:
            flatten[k] *= ring_size
    own = np.empty((len(near), 2, 2))
    own[:] = flatten[-1]
    between = geometric_means(flatten[:-1], own)
    present = np.empty((len(near), 2))
    for k in range(len(near)):
        x, y = centre[near[k], 0] - centre[i, 0], centre[near[k], 1] - centre[i, 1]
        for axis in range(2):
            present[k, axis] = between[k, axis, 0] * x + between[k, axis, 1] * y
    return present


@compiled
def _full_crosses(arms: np.ndarray, present: np.ndarray, opposite: np.ndarray, count: int) -> np.ndarray:
    """Return how badly each pair of arms fits, (m, m), with spots opposite and at so many corners."""
    misfit, corners = np.empty((len(arms), len(arms))), np.empty(4)
    for j in range(len(arms)):
        for k in range(len(arms)):
            u, v = present[arms[j]], present[arms[k]]
            corners[0], corners[1] = _corner(u, v, 1.0, 1.0, present), _corner(u, v, 1.0, -1.0, present)
            corners[2], corners[3] = _corner(u, v, -1.0, 1.0, present), _corner(u, v, -1.0, -1.0, present)
            worst = np.sort(corners)[count - 1]
            misfit[j, k] = max(opposite[arms[j]], opposite[arms[k]], worst)
    return misfit


@compiled
def _half_crosses(arms: np.ndarray, present: np.ndarray, opposite: np.ndarray) -> np.ndarray:
    """Return how badly each arm with a spot opposite it and one to one side, with both corners, fits.

    It is all there is where only two rows of dots are seen.
    """
    misfit = np.empty((len(arms), len(present)))
    for j in range(len(arms)):
        for k in range(len(present)):
            u, v = present[arms[j]], present[k]
            corners = max(_corner(u, v, 1.0, 1.0, present), _corner(u, v, -1.0, 1.0, present))
            misfit[j, k] = max(opposite[arms[j]], corners)
    return misfit


@compiled
def _corner(u: np.ndarray, v: np.ndarray, a: float, b: float, present: np.ndarray) -> float:
    """Return the distance of the nearest spot from the corner of two arms, in steps."""
    return _off(present, a * u[0] + b * v[0], a * u[1] + b * v[1]) / min(_length(u), _length(v))


@compiled
def _smallest(
    first: np.ndarray,
    second: np.ndarray,
    misfit: np.ndarray,
    present: np.ndarray,
    wanted: tuple[float, CrossLimits],
) -> tuple[int, int, float]:
    """Return the pair of the smallest cell that is square and fits; of several, the one that fits best.

    -1 where there is none. Wanted are the logarithm of the ratio of the steps, and limits.
    """
    expected, limits = wanted
    area = np.full(misfit.shape, np.inf)
    for j in range(len(first)):
        for k in range(len(second)):
            u, v = present[first[j]], present[second[k]]
            product = _length(u) * _length(v)
            cosine = abs(u[0] * v[0] + u[1] * v[1]) / product
            skew = max(cosine, abs(abs(np.log(_length(u) / _length(v))) - expected))
            if skew < limits.seed_shape_log and misfit[j, k] < limits.seed_residual_steps:
                area[j, k] = product
    limit = limits.seed_cell_factor * area.min()
    best, one, other = np.inf, -1, -1
    for j in range(len(first)):
        for k in range(len(second)):
            if area[j, k] < limit and misfit[j, k] < best:
                best, one, other = misfit[j, k], first[j], second[k]
    return one, other, best


@compiled
def _is_coarse(u: np.ndarray, v: np.ndarray, present: np.ndarray, most: float) -> bool:
    """Tell whether spots lie half-way in the cells: for want of a neighbour the seed skips every other."""
    limit = most * min(_length(u), _length(v))
    corners, across, along = 0, 0, 0
    for side in (-0.5, 0.5):
        for half in (-0.5, 0.5):
            corners += _off(present, side * u[0] + half * v[0], side * u[1] + half * v[1]) < limit
        for k in (-1.0, 0.0, 1.0):
            across += _off(present, side * u[0] + k * v[0], side * u[1] + k * v[1]) < limit
            along += _off(present, side * v[0] + k * u[0], side * v[1] + k * u[1]) < limit
    return max(corners, across, along) > 1


@compiled
def _nearest(present: np.ndarray, x: float, y: float) -> int:
    """Return the spot nearest to a place."""
    best, least = 0, np.inf
    for k in range(len(present)):
        square = (present[k, 0] - x) ** 2 + (present[k, 1] - y) ** 2
        if square < least:
            best, least = k, square
    return best


@compiled
def _off(present: np.ndarray, x: float, y: float) -> float:
    """Return the distance of the spot nearest to a place."""
    least = np.inf
    for k in range(len(present)):
        square = (present[k, 0] - x) ** 2 + (present[k, 1] - y) ** 2
        least = min(least, square)
    return sqrt(least)


@compiled
def _length(step: np.ndarray) -> float:
    """Return the length of a step."""
    return sqrt(step[0] * step[0] + step[1] * step[1])
