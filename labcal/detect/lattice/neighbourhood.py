"""Grid nodes predicted from the nodes around them, by a local homography or polynomial, in compiled code.

A grid is an integer array (nodes along a, nodes along b) of spot numbers, -1 where no spot is known. A
prediction is x, y, then the local steps along a (x, y) and along b (x, y), px.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np

from labcal.detect.cholesky import factorise, solve
from labcal.detect.compiled import compiled

PREDICTION = 6
_TERMS = 6
_CURVED = 2
"""Rows or columns: more determine a curvature."""
_SINGULAR = 1e-9
_FLAT = 1e-6
"""Least area of a cell, of the sum of its steps' squares."""


class PredictionLimits(NamedTuple):
    """The settings of the grid that predictions take."""

    windows_nodes: tuple[int, int, int, int]
    min_near_nodes: int
    min_far_nodes: int
    min_depth_share: float


@compiled
def predict(
    grid: np.ndarray,
    centre: np.ndarray,
    node: tuple[int, int],
    limits: PredictionLimits,
    prediction: np.ndarray,
) -> bool:
    """Predict a node from its neighbours, by a local homography or a polynomial, whichever fits them better.

    The homography follows perspective, the polynomial of second degree distortion as well; what the
    neighbours do not determine is left out. What is known at the node itself does not enter. False where the
    neighbours are too few or lie on one line.
    """
    windows = limits.windows_nodes
    near = np.empty(((2 * max(windows) + 1) ** 2, 4))
    count, in_a, in_b = 0, 0, 0
    for window in windows:
        count, in_a, in_b = _neighbours(grid, centre, node, window, near)
        is_near = window <= windows[1]
        needed, lines = (limits.min_near_nodes, 2) if is_near else (limits.min_far_nodes, _CURVED + 1)
        if count >= needed and min(in_a, in_b) >= lines:
            break
    else:
        return False
    known = near[:count]
    smooth, projective = np.empty(PREDICTION), np.empty(PREDICTION)
    rough = _polynomial(known, _terms(count, in_a, in_b), smooth)
    if not np.isfinite(rough):
        rough = _polynomial(known, _terms(0, in_a, in_b), smooth)
    perspective = (
        _projective(known, limits.min_depth_share, projective) if count > limits.min_near_nodes else np.inf
    )
    if not np.isfinite(min(rough, perspective)):
        return False
    chosen = projective if perspective < rough else smooth
    for k in range(PREDICTION):
        prediction[k] = chosen[k]
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
    """Return which of 1, a, b, ab, aa and bb some nodes, in so many rows and columns, determine."""
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
            for j in range(i + 1):
                normal[i, j] += row[i] * row[j]
    for i in range(_TERMS):
        if not use[i]:
            for j in range(_TERMS):
                normal[i, j] = normal[j, i] = 0.0
            normal[i, i] = 1.0
            right[0, i] = right[1, i] = 0.0
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
def _projective(near: np.ndarray, min_depth: float, prediction: np.ndarray) -> float:
    """Fit a homography; return the mean square of what is left a degree of freedom, infinite if none."""
    n = 8
    normal, right = np.zeros((n, n)), np.zeros(n)
    middle_x = middle_y = squares = 0.0
    for k in range(len(near)):
        middle_x, middle_y = middle_x + near[k, 2], middle_y + near[k, 3]
    middle_x, middle_y = middle_x / len(near), middle_y / len(near)
    for k in range(len(near)):
        squares += (near[k, 2] - middle_x) ** 2 + (near[k, 3] - middle_y) ** 2
    size = sqrt(squares / len(near))
    _add_projective(near, (middle_x, middle_y, size), normal, right)
    if not factorise(normal, n, _SINGULAR):
        return np.inf
    solve(normal, right)
    squares = 0.0
    for k in range(len(near)):
        p, q = near[k, 0], near[k, 1]
        depth = 1.0 + right[6] * p + right[7] * q
        if depth < min_depth:
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
def _add_projective(
    near: np.ndarray, scale: tuple[float, float, float], normal: np.ndarray, right: np.ndarray
) -> None:
    """Sum a homography's normal equations; places count from a middle, in sizes.

    The rows of x and of y are (1, p, q, 0, 0, 0, -xp, -xq) and (0, 0, 0, 1, p, q, -yp, -yq).
    """
    plane = 3
    row = np.empty(plane)
    middle_x, middle_y, size = scale
    for k in range(len(near)):
        row[0], row[1], row[2] = 1.0, near[k, 0], near[k, 1]
        x, y = (near[k, 2] - middle_x) / size, (near[k, 3] - middle_y) / size
        square = x * x + y * y
        for i in range(plane):
            right[i] += row[i] * x
            right[plane + i] += row[i] * y
            for j in range(i + 1):
                normal[i, j] += row[i] * row[j]
        for i in range(2):
            right[6 + i] -= square * row[1 + i]
            for j in range(plane):
                normal[6 + i, j] -= x * row[1 + i] * row[j]
                normal[6 + i, plane + j] -= y * row[1 + i] * row[j]
            for j in range(i + 1):
                normal[6 + i, 6 + j] += square * row[1 + i] * row[1 + j]
    for i in range(plane):
        for j in range(plane):
            normal[plane + i, plane + j] = normal[i, j]


@compiled
def predict_all(
    grid: np.ndarray, centre: np.ndarray, nodes: np.ndarray, limits: PredictionLimits
) -> np.ndarray:
    """Return the predictions of nodes (n, 2), shape (n, PREDICTION), NaN where there is none."""
    predictions = np.full((len(nodes), PREDICTION), np.nan)
    values = np.empty(PREDICTION)
    for k in range(len(nodes)):
        if predict(grid, centre, (nodes[k, 0], nodes[k, 1]), limits, values):
            predictions[k] = values
    return predictions


@compiled
def residual_in_steps(prediction: np.ndarray, x: float, y: float) -> float:
    """Return how many steps a place is from a prediction; infinite on a degenerate grid."""
    ax, ay, bx, by = prediction[2], prediction[3], prediction[4], prediction[5]
    determinant = ax * by - ay * bx
    if abs(determinant) < _FLAT * (ax * ax + ay * ay + bx * bx + by * by):
        return np.inf
    dx, dy = x - prediction[0], y - prediction[1]
    steps: float = sqrt((by * dx - bx * dy) ** 2 + (ax * dy - ay * dx) ** 2) / abs(determinant)
    return steps
