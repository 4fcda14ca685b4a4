"""Growth of a lattice from a seed, and its consistency: nodes added and taken out, in compiled code.

Grids and predictions are those of `labcal.detect.lattice.neighbourhood`.
"""

from typing import NamedTuple

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.lattice.neighbourhood import PREDICTION, PredictionLimits, predict, residual_in_steps

_UNTRIED = -1


class GrowthLimits(NamedTuple):
    """The settings of the grid that growth takes."""

    grow_radius_log: float
    grow_residual_steps: float
    bridge_residual_steps: float
    bridge_nodes: int
    keep_residual_steps: float
    part_gap_nodes: int


@compiled
def grow(
    grid: np.ndarray,
    centre: np.ndarray,
    radius: np.ndarray,
    free: np.ndarray,
    limits: tuple[GrowthLimits, PredictionLimits],
) -> None:
    """Add spots to a grid, in place, from its nodes outward, each by its neighbours' prediction.

    Parameters
    ----------
    grid : ndarray of int
        With a seed in it.
    centre, radius : ndarray, shapes (n, 2) and (n,)
        Of all spots, px.
    free : ndarray of bool, shape (n,)
        Spots that may be taken; those that are taken are cleared.
    limits : tuple of GrowthLimits and PredictionLimits
    """
    tried = np.full(grid.shape, _UNTRIED)
    reach = 1
    while reach <= limits[0].bridge_nodes and free.any():
        found = _candidates(grid, centre, (radius, free), tried, reach, limits)
        order = np.argsort(found[:, 0])
        added = False
        for k in order:
            a, b, spot = int(found[k, 1]), int(found[k, 2]), int(found[k, 3])
            if grid[a, b] < 0 and free[spot]:
                grid[a, b] = spot
                free[spot] = False
                added = True
        if added:
            reach = 1
        else:
            reach += 1
            tried[:] = _UNTRIED


@compiled
def _candidates(
    grid: np.ndarray,
    centre: np.ndarray,
    spots: tuple[np.ndarray, np.ndarray],
    tried: np.ndarray,
    reach: int,
    limits: tuple[GrowthLimits, PredictionLimits],
) -> np.ndarray:
    """Return the empty nodes near the known ones that a free spot agrees with: residual, a, b, spot."""
    radius, free = spots
    growth, prediction_limits = limits
    farthest = growth.grow_residual_steps if reach == 1 else growth.bridge_residual_steps
    rows, columns = grid.shape
    top, bottom, left, right = extent(grid)
    top, bottom = max(top - reach, 0), min(bottom + reach, rows - 1)
    left, right = max(left - reach, 0), min(right + reach, columns - 1)
    found = np.empty((max(bottom - top + 1, 0) * max(right - left + 1, 0), 4))
    count = 0
    prediction = np.empty(PREDICTION)
    for a in range(top, bottom + 1):
        for b in range(left, right + 1):
            if grid[a, b] >= 0:
                continue
            near, typical = _beside(grid, radius, a, b, reach)
            if near == 0 or tried[a, b] == near:
                continue
            tried[a, b] = near
            if not predict(grid, centre, (a, b), prediction_limits, prediction):
                continue
            best = _nearest(centre, free, prediction)
            if best < 0 or abs(np.log(radius[best]) - typical) >= growth.grow_radius_log:
                continue
            off = residual_in_steps(prediction, centre[best, 0], centre[best, 1])
            if off < farthest:
                found[count, 0], found[count, 1], found[count, 2], found[count, 3] = off, a, b, best
                count += 1
    return found[:count].copy()


@compiled
def _beside(grid: np.ndarray, radius: np.ndarray, a: int, b: int, reach: int) -> tuple[int, float]:
    """Return how many nodes within reach of one are known, and their mean log radius."""
    near, total = 0, 0.0
    for i in range(max(a - reach, 0), min(a + reach + 1, grid.shape[0])):
        for j in range(max(b - reach, 0), min(b + reach + 1, grid.shape[1])):
            if grid[i, j] >= 0:
                near += 1
                total += np.log(radius[grid[i, j]])
    return near, total / max(near, 1)


@compiled
def _nearest(centre: np.ndarray, free: np.ndarray, place: np.ndarray) -> int:
    """Return the free spot nearest to a place, -1 where none is free."""
    best, nearest = -1, np.inf
    for k in range(len(centre)):
        if free[k]:
            far = (centre[k, 0] - place[0]) ** 2 + (centre[k, 1] - place[1]) ** 2
            if far < nearest:
                best, nearest = k, far
    return best


@compiled
def extent(grid: np.ndarray) -> tuple[int, int, int, int]:
    """Return the first and last row, and the first and last column, that hold a spot."""
    top, bottom, left, right = grid.shape[0], -1, grid.shape[1], -1
    for a in range(grid.shape[0]):
        for b in range(grid.shape[1]):
            if grid[a, b] >= 0:
                top, bottom = min(top, a), max(bottom, a)
                left, right = min(left, b), max(right, b)
    return top, bottom, left, right


@compiled
def keep_largest_part(grid: np.ndarray, gap: int) -> None:
    """Take out, in place, all but the largest set of nodes that hang together over gaps."""
    rows, columns = grid.shape
    part = np.zeros(grid.shape, dtype=np.int64)
    edge = np.empty((grid.size, 2), dtype=np.int64)
    number, best, most = 0, 0, 0
    for a in range(rows):
        for b in range(columns):
            if grid[a, b] < 0 or part[a, b] > 0:
                continue
            number += 1
            part[a, b] = number
            edge[0, 0], edge[0, 1] = a, b
            done, reached = 0, 1
            while done < reached:
                reached = _spread(grid, part, edge, (done, reached), gap)
                done += 1
            if reached > most:
                best, most = number, reached
    for a in range(rows):
        for b in range(columns):
            if part[a, b] != best:
                grid[a, b] = -1


@compiled
def _spread(grid: np.ndarray, part: np.ndarray, edge: np.ndarray, place: tuple[int, int], gap: int) -> int:
    """Add the nodes within a gap of one of `edge` to its part and to `edge`; return how many are in there."""
    done, reached = place
    a, b = edge[done, 0], edge[done, 1]
    for i in range(max(a - gap, 0), min(a + gap + 1, grid.shape[0])):
        for j in range(max(b - gap, 0), min(b + gap + 1, grid.shape[1])):
            if grid[i, j] >= 0 and part[i, j] == 0:
                part[i, j] = part[a, b]
                edge[reached, 0], edge[reached, 1] = i, j
                reached += 1
    return reached


@compiled
def drop_inconsistent(
    grid: np.ndarray, centre: np.ndarray, limits: tuple[GrowthLimits, PredictionLimits]
) -> None:
    """Take out, in place, the nodes that disagree with their neighbours, the worst first until none does.

    A row linked one step off disagrees along its seam; dropping the seam cuts the grid in parts.
    """
    rows, columns = grid.shape
    near, prediction = limits[1].windows_nodes[1], np.empty(PREDICTION)
    residuals = np.full(grid.shape, -np.inf)
    for a in range(rows):
        for b in range(columns):
            if grid[a, b] >= 0:
                residuals[a, b] = _node_residual(grid, centre, (a, b), limits[1], prediction)
    while True:
        worst = int(np.argmax(residuals))
        a, b = worst // columns, worst % columns
        if residuals[a, b] <= limits[0].keep_residual_steps:
            return
        grid[a, b], residuals[a, b] = -1, -np.inf
        for i in range(max(a - near, 0), min(a + near + 1, rows)):
            for j in range(max(b - near, 0), min(b + near + 1, columns)):
                if grid[i, j] >= 0:
                    residuals[i, j] = _node_residual(grid, centre, (i, j), limits[1], prediction)


@compiled
def _node_residual(
    grid: np.ndarray,
    centre: np.ndarray,
    node: tuple[int, int],
    limits: PredictionLimits,
    prediction: np.ndarray,
) -> float:
    """Return the distance of a spot from its prediction, in steps; infinite if there is none."""
    if not predict(grid, centre, node, limits, prediction):
        return np.inf
    spot = grid[node]
    return residual_in_steps(prediction, centre[spot, 0], centre[spot, 1])
