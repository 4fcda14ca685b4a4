"""Grid nodes told by the nodes around them: prediction, growth and consistency of a lattice.

A grid is an integer array (nodes along a, nodes along b) of spot numbers, -1 where no spot is known. A
prediction is x, y, then the local steps along a (x, y) and along b (x, y), px.
"""

from math import sqrt

import numpy as np

from labcal.detect.cholesky import factorise, solve
from labcal.detect.compiled import compiled

PREDICTION = 6
_NARROW, _WIDE = 2, 3
"""Nodes to either side: the wider window where the near ones are too few."""
_FEWEST = 5
"""Known nodes for a prediction."""
_TERMS = 6
_CURVED = 2
"""Rows or columns: more tell a curvature."""
_SINGULAR = 1e-9
_FLAT = 1e-6
"""Least area of a cell, of the sum of its steps' squares."""
_GROW_MISS = 0.25
"""Of a step, where a node is added."""
_KEEP_MISS = 0.12
"""Of a step, once all neighbours are known."""
_UNTRIED = -1


@compiled
def predict(grid: np.ndarray, centre: np.ndarray, a: int, b: int, prediction: np.ndarray) -> bool:
    """Predict a node from its neighbours by a polynomial of the degree that they support.

    The second degree follows perspective and distortion locally; with too few neighbours, or all in few rows
    or columns, the terms that these cannot tell are left out. What is known at the node itself does not
    enter. False where the neighbours are too few or lie on one line.
    """
    for window in (_NARROW, _WIDE):
        count, in_a, in_b = 0, 0, 0
        low_a, high_a = max(a - window, 0), min(a + window, grid.shape[0] - 1)
        low_b, high_b = max(b - window, 0), min(b + window, grid.shape[1] - 1)
        seen_b = np.zeros(2 * window + 1, dtype=np.bool_)
        for i in range(low_a, high_a + 1):
            some = False
            for j in range(low_b, high_b + 1):
                if grid[i, j] >= 0 and not (i == a and j == b):
                    count += 1
                    some = True
                    seen_b[j - b + window] = True
            in_a += some
        in_b = seen_b.sum()
        if count >= _FEWEST and min(in_a, in_b) > 1:
            break
    if count < _FEWEST or min(in_a, in_b) <= 1:
        return False
    use = _terms(count, in_a, in_b)
    box = (low_a, high_a, low_b, high_b)
    if not _fit(grid, centre, (a, b), box, use, prediction):
        use[3:] = False
        return _fit(grid, centre, (a, b), box, use, prediction)
    return True


@compiled
def _terms(count: int, in_a: int, in_b: int) -> np.ndarray:
    """Return which of 1, a, b, ab, aa and bb some nodes, in so many rows and columns, can tell."""
    use = np.ones(_TERMS, dtype=np.bool_)
    spare = count - 4
    for term, can in ((3, True), (4, in_a > _CURVED), (5, in_b > _CURVED)):
        use[term] = can and spare > 0
        spare -= use[term]
    return use


@compiled
def _fit(
    grid: np.ndarray,
    centre: np.ndarray,
    node: tuple[int, int],
    box: tuple[int, int, int, int],
    use: np.ndarray,
    prediction: np.ndarray,
) -> bool:
    """Fit the terms in use to the known nodes of a box; False where these cannot tell them."""
    normal, right = np.zeros((_TERMS, _TERMS)), np.zeros((2, _TERMS))
    row = np.empty(_TERMS)
    for i in range(box[0], box[1] + 1):
        for j in range(box[2], box[3] + 1):
            spot = grid[i, j]
            if spot < 0 or (i == node[0] and j == node[1]):
                continue
            p, q = float(i - node[0]), float(j - node[1])
            row[0], row[1], row[2], row[3], row[4], row[5] = 1.0, p, q, p * q, p * p, q * q
            for k in range(_TERMS):
                right[0, k] += row[k] * centre[spot, 0]
                right[1, k] += row[k] * centre[spot, 1]
                for m in range(_TERMS):
                    normal[k, m] += row[k] * row[m]
    for k in range(_TERMS):
        if not use[k]:
            normal[k, :] = 0.0
            normal[:, k] = 0.0
            normal[k, k] = 1.0
            right[:, k] = 0.0
    if not factorise(normal, _TERMS, _SINGULAR):
        return False
    for side in range(2):
        solve(normal, right[side])
        prediction[side], prediction[2 + side], prediction[4 + side] = right[side, :3]
    return True


@compiled
def miss(prediction: np.ndarray, x: float, y: float) -> float:
    """Return how many steps a place is from a prediction; infinite on a degenerate grid."""
    ax, ay, bx, by = prediction[2], prediction[3], prediction[4], prediction[5]
    determinant = ax * by - ay * bx
    if abs(determinant) < _FLAT * (ax * ax + ay * ay + bx * bx + by * by):
        return np.inf
    dx, dy = x - prediction[0], y - prediction[1]
    steps: float = sqrt((by * dx - bx * dy) ** 2 + (ax * dy - ay * dx) ** 2) / abs(determinant)
    return steps


@compiled
def grow(grid: np.ndarray, centre: np.ndarray, radius: np.ndarray, free: np.ndarray, alike: float) -> None:
    """Add spots to a grid, in place, from its nodes outward, each by its neighbours' prediction.

    Parameters
    ----------
    grid : ndarray of int
        With a seed in it.
    centre, radius : ndarray, shapes (n, 2) and (n,)
        Of all spots, px.
    free : ndarray of bool, shape (n,)
        Spots that may be taken; those that are taken are cleared.
    alike : float
        Most that the logarithms of neighbours' radii differ.
    """
    tried = np.full(grid.shape, _UNTRIED)
    reach = 1
    while reach <= 2:  # noqa: PLR2004 - a gap of one node is bridged, no wider one
        found = _candidates(grid, centre, (radius, free), tried, reach, alike)
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
    alike: float,
) -> np.ndarray:
    """Return the empty nodes near the known ones that a free spot agrees with: miss, a, b, spot."""
    radius, free = spots
    rows, columns = grid.shape
    top, bottom, left, right = _extent(grid)
    top, bottom = max(top - reach, 0), min(bottom + reach, rows - 1)
    left, right = max(left - reach, 0), min(right + reach, columns - 1)
    found = np.empty((max(bottom - top + 1, 0) * max(right - left + 1, 0), 4))
    count = 0
    prediction = np.empty(PREDICTION)
    for a in range(top, bottom + 1):
        for b in range(left, right + 1):
            if grid[a, b] >= 0:
                continue
            near, typical, beside = _beside(grid, radius, a, b, reach)
            if not beside or tried[a, b] == near:
                continue
            tried[a, b] = near
            if not predict(grid, centre, a, b, prediction):
                continue
            best = _nearest(centre, free, prediction)
            if best < 0 or abs(np.log(radius[best]) - typical) >= alike:
                continue
            off = miss(prediction, centre[best, 0], centre[best, 1])
            if off < _GROW_MISS:
                found[count, 0], found[count, 1], found[count, 2], found[count, 3] = off, a, b, best
                count += 1
    return found[:count].copy()


@compiled
def _beside(grid: np.ndarray, radius: np.ndarray, a: int, b: int, reach: int) -> tuple[int, float, bool]:
    """Return how many nodes near one are known, their mean log radius, and whether one is within reach."""
    near, beside, total = 0, False, 0.0
    for i in range(max(a - _NARROW, 0), min(a + _NARROW + 1, grid.shape[0])):
        for j in range(max(b - _NARROW, 0), min(b + _NARROW + 1, grid.shape[1])):
            if grid[i, j] >= 0:
                near += 1
                total += np.log(radius[grid[i, j]])
                beside |= abs(i - a) <= reach and abs(j - b) <= reach
    return near, total / max(near, 1), beside


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
def _extent(grid: np.ndarray) -> tuple[int, int, int, int]:
    """Return the first and last row, and the first and last column, that hold a spot."""
    top, bottom, left, right = grid.shape[0], -1, grid.shape[1], -1
    for a in range(grid.shape[0]):
        for b in range(grid.shape[1]):
            if grid[a, b] >= 0:
                top, bottom = min(top, a), max(bottom, a)
                left, right = min(left, b), max(right, b)
    return top, bottom, left, right


@compiled
def drop_inconsistent(grid: np.ndarray, centre: np.ndarray) -> None:
    """Take out, in place, the nodes that disagree with their neighbours, the worst first until none does.

    A row linked one step off disagrees along its seam; dropping the seam cuts the grid in parts.
    """
    rows, columns = grid.shape
    prediction = np.empty(PREDICTION)
    misses = np.full(grid.shape, -np.inf)
    for a in range(rows):
        for b in range(columns):
            if grid[a, b] >= 0:
                misses[a, b] = _node_miss(grid, centre, a, b, prediction)
    while True:
        worst = int(np.argmax(misses))
        a, b = worst // columns, worst % columns
        if misses[a, b] <= _KEEP_MISS:
            return
        grid[a, b], misses[a, b] = -1, -np.inf
        for i in range(max(a - _WIDE, 0), min(a + _WIDE + 1, rows)):
            for j in range(max(b - _WIDE, 0), min(b + _WIDE + 1, columns)):
                if grid[i, j] >= 0:
                    misses[i, j] = _node_miss(grid, centre, i, j, prediction)


@compiled
def _node_miss(grid: np.ndarray, centre: np.ndarray, a: int, b: int, prediction: np.ndarray) -> float:
    """Return how far a spot is from what its neighbours say, in steps; infinite where they say nothing."""
    if not predict(grid, centre, a, b, prediction):
        return np.inf
    spot = grid[a, b]
    return miss(prediction, centre[spot, 0], centre[spot, 1])
