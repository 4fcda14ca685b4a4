"""Grid nodes told by the nodes around them: prediction, growth and consistency of a lattice.

A grid is an integer array (nodes along a, nodes along b) of spot numbers, -1 where no spot is known. A
prediction is x, y, then the local steps along a (x, y) and along b (x, y), px.
"""

from math import sqrt

import numpy as np

from labcal.detect.cholesky import factorise, solve
from labcal.detect.compiled import compiled

PREDICTION = 6
_NARROW, _WIDE, _WIDER, _WIDEST = 2, 3, 5, 7
"""Nodes to either side: wider windows where the near ones are too few."""
_FEWEST, _FEWEST_FAR = 5, 12
"""Known nodes for a prediction, in a wider window."""
_LEAST_DEPTH = 0.2
"""Of a neighbour over that of the node, or the horizon is near."""
_TERMS = 6
_CURVED = 2
"""Rows or columns: more tell a curvature."""
_SINGULAR = 1e-9
_FLAT = 1e-6
"""Least area of a cell, of the sum of its steps' squares."""
_GROW_MISS, _BRIDGE_MISS = 0.25, 0.15
"""Of a step, where a node is added beside its neighbours, and beyond a gap."""
_WIDEST_GAP = 5
"""Steps over hidden nodes to what goes on behind."""
_KEEP_MISS = 0.12
"""Of a step, once all neighbours are known."""
_UNTRIED = -1


@compiled
def predict(grid: np.ndarray, centre: np.ndarray, a: int, b: int, prediction: np.ndarray) -> bool:
    """Predict a node from its neighbours, by a local homography or a polynomial, whichever fits them better.

    The homography follows perspective, the polynomial of second degree distortion as well; what the
    neighbours cannot tell is left out. What is known at the node itself does not enter. False where the
    neighbours are too few or lie on one line.
    """
    near = np.empty(((2 * _WIDEST + 1) ** 2, 4))
    count, in_a, in_b = 0, 0, 0
    for window in (_NARROW, _WIDE, _WIDER, _WIDEST):
        count, in_a, in_b = _neighbours(grid, centre, (a, b), window, near)
        needed, lines = (_FEWEST, 2) if window <= _WIDE else (_FEWEST_FAR, _CURVED + 1)
        if count >= needed and min(in_a, in_b) >= lines:
            break
    else:
        return False
    known = near[:count]
    smooth, projective = np.empty(PREDICTION), np.empty(PREDICTION)
    rough = _polynomial(known, _terms(count, in_a, in_b), smooth)
    if not np.isfinite(rough):
        rough = _polynomial(known, _terms(0, in_a, in_b), smooth)
    perspective = _projective(known, projective) if count > _FEWEST else np.inf
    if not np.isfinite(min(rough, perspective)):
        return False
    chosen = projective if perspective < rough else smooth
    prediction[:] = chosen
    return True


@compiled
def _neighbours(
    grid: np.ndarray, centre: np.ndarray, node: tuple[int, int], window: int, near: np.ndarray
) -> tuple[int, int, int]:
    """Write steps along a and b, x and y of the nodes known around one; return how many, on what lines."""
    a, b = node
    count, in_a = 0, 0
    seen_b = np.zeros(2 * window + 1, dtype=np.bool_)
    for i in range(max(a - window, 0), min(a + window + 1, grid.shape[0])):
        some = False
        for j in range(max(b - window, 0), min(b + window + 1, grid.shape[1])):
            spot = grid[i, j]
            if spot >= 0 and not (i == a and j == b):
                near[count, 0], near[count, 1] = i - a, j - b
                near[count, 2], near[count, 3] = centre[spot, 0], centre[spot, 1]
                count += 1
                some = True
                seen_b[j - b + window] = True
        in_a += some
    return count, in_a, seen_b.sum()


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
def _polynomial(near: np.ndarray, use: np.ndarray, prediction: np.ndarray) -> float:
    """Fit the terms in use; return the mean square of what is left a degree of freedom, infinite if none."""
    normal, right = np.zeros((_TERMS, _TERMS)), np.zeros((2, _TERMS))
    row = np.empty(_TERMS)
    for k in range(len(near)):
        p, q = near[k, 0], near[k, 1]
        row[0], row[1], row[2], row[3], row[4], row[5] = 1.0, p, q, p * q, p * p, q * q
        for i in range(_TERMS):
            right[0, i] += row[i] * near[k, 2]
            right[1, i] += row[i] * near[k, 3]
            for j in range(_TERMS):
                normal[i, j] += row[i] * row[j]
    for i in range(_TERMS):
        if not use[i]:
            normal[i, :] = 0.0
            normal[:, i] = 0.0
            normal[i, i] = 1.0
            right[:, i] = 0.0
    if not factorise(normal, _TERMS, _SINGULAR):
        return np.inf
    for side in range(2):
        solve(normal, right[side])
        prediction[side], prediction[2 + side], prediction[4 + side] = (
            right[side, 0],
            right[side, 1],
            right[side, 2],
        )
    left: float = _left(near, right, row) / max(len(near) - use.sum(), 0.5)
    return left


@compiled
def _left(near: np.ndarray, coefficients: np.ndarray, row: np.ndarray) -> float:
    """Return the sum of squares that a polynomial leaves."""
    squares = 0.0
    for k in range(len(near)):
        p, q = near[k, 0], near[k, 1]
        row[0], row[1], row[2], row[3], row[4], row[5] = 1.0, p, q, p * q, p * p, q * q
        for side in range(2):
            off = near[k, 2 + side]
            for i in range(_TERMS):
                off -= row[i] * coefficients[side, i]
            squares += off * off
    return squares


@compiled
def _projective(near: np.ndarray, prediction: np.ndarray) -> float:
    """Fit a homography; return the mean square of what is left a degree of freedom, infinite if none."""
    n = 8
    normal, right = np.zeros((n, n)), np.zeros(n)
    row = np.empty(n)
    middle_x, middle_y = near[:, 2].mean(), near[:, 3].mean()
    size = sqrt(((near[:, 2] - middle_x) ** 2 + (near[:, 3] - middle_y) ** 2).mean())
    for k in range(len(near)):
        p, q = near[k, 0], near[k, 1]
        for side in range(2):
            value = (near[k, 2 + side] - (middle_x if side == 0 else middle_y)) / size
            row[:] = 0.0
            row[3 * side], row[3 * side + 1], row[3 * side + 2] = 1.0, p, q
            row[6], row[7] = -value * p, -value * q
            for i in range(n):
                right[i] += row[i] * value
                for j in range(n):
                    normal[i, j] += row[i] * row[j]
    if not factorise(normal, n, _SINGULAR):
        return np.inf
    solve(normal, right)
    squares = 0.0
    for k in range(len(near)):
        p, q = near[k, 0], near[k, 1]
        depth = 1.0 + right[6] * p + right[7] * q
        if depth < _LEAST_DEPTH:
            return np.inf
        x, y = right[0] + right[1] * p + right[2] * q, right[3] + right[4] * p + right[5] * q
        squares += (middle_x + size * x / depth - near[k, 2]) ** 2
        squares += (middle_y + size * y / depth - near[k, 3]) ** 2
    prediction[0], prediction[1] = middle_x + size * right[0], middle_y + size * right[3]
    for k in range(2):
        prediction[2 + 2 * k] = size * (right[1 + k] - right[0] * right[6 + k])
        prediction[3 + 2 * k] = size * (right[4 + k] - right[3] * right[6 + k])
    return squares / max(len(near) - 0.5 * n, 0.5)


@compiled
def predict_all(grid: np.ndarray, centre: np.ndarray, nodes: np.ndarray) -> np.ndarray:
    """Return the predictions of nodes (n, 2), shape (n, PREDICTION), NaN where there is none."""
    predictions = np.full((len(nodes), PREDICTION), np.nan)
    numbers = np.empty(PREDICTION)
    for k in range(len(nodes)):
        if predict(grid, centre, nodes[k, 0], nodes[k, 1], numbers):
            predictions[k] = numbers
    return predictions


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
    while reach <= _WIDEST_GAP and free.any():
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
            near, typical = _beside(grid, radius, a, b, reach)
            if near == 0 or tried[a, b] == near:
                continue
            tried[a, b] = near
            if not predict(grid, centre, a, b, prediction):
                continue
            best = _nearest(centre, free, prediction)
            if best < 0 or abs(np.log(radius[best]) - typical) >= alike:
                continue
            off = miss(prediction, centre[best, 0], centre[best, 1])
            if off < (_GROW_MISS if reach == 1 else _BRIDGE_MISS):
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
