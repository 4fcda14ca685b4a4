"""Fit of a homography with radial distortion to the corners of a board, in compiled code.

Parameters are those of :class:`~labcal.detect.corners.board_lens.BoardLens`: the matrix 9, the centre of
distortion 2, px, and the coefficients 3.
"""

from math import sqrt

import numpy as np

from labcal.detect.cholesky import factorise, solve
from labcal.detect.compiled import compiled

RADIAL = 3
"""Powers of the squared radius."""
HOMOGRAPHY, ALL = 9, 9 + 2 + RADIAL
"""Parameters: of the matrix alone; with centre and coefficients."""
_CENTRE = 0.1
"""Expected distance of the centre of distortion from the picture's, over half its larger side."""
_TERMS = (1.0, 0.5, 0.25)
"""Expected coefficients: a fisheye of 180 degrees across the picture has 0.8, 0.14 and 0.02."""
_MEDIAN, _LEAST_SIGMA = 0.72, 1e-3
"""Variance over the median of squared distances, of normal numbers; least error of a corner, px."""
_HEAVY = 4.0
"""Degrees of freedom of Student's distribution, whose weights a fit has."""
_STEPS, _CONVERGED = 40, 1e-4
"""Steps of Levenberg and Marquardt at most; their end, px."""
_BEGIN, _MOST_DAMPED, _MORE, _LESS = 1e-3, 1e6, 10.0, 0.1
_RIDGE, _SINGULAR = 1e-12, 1e-15
Corners = tuple[np.ndarray, np.ndarray]
"""Places on the board (n, 2), in squares, and in the picture, px."""


@compiled
def fit_lens(
    lens: np.ndarray, corners: Corners, unit: float, middle: np.ndarray
) -> tuple[bool, float, float]:
    """Fit a lens, in place, from a homography on; return whether that is possible, and what both leave.

    That is the sum of squared residuals, px^2, of the best homography and of the lens, both with the weights
    of the latter. `unit` is half the picture's larger side, `middle` its middle, px.
    """
    n = len(corners[1])
    plane, e, rows = np.empty((n, 2)), np.empty((n, 2)), np.empty((n, 2, ALL))
    if not _fitted(lens, corners, (unit, middle), HOMOGRAPHY, (plane, rows)):
        return False, 0.0, 0.0
    if not _fitted(lens, corners, (unit, middle), ALL, (e, rows)):
        return False, 0.0, 0.0
    sigma, of_plane, of_lens = _sigma(e), 0.0, 0.0
    for k in range(n):
        weight = _weight(e[k], sigma)
        of_plane += weight * (plane[k, 0] ** 2 + plane[k, 1] ** 2)
        of_lens += weight * (e[k, 0] ** 2 + e[k, 1] ** 2)
    return True, of_plane, of_lens


@compiled
def _fitted(
    lens: np.ndarray,
    corners: Corners,
    picture: tuple[float, np.ndarray],
    free: int,
    left: tuple[np.ndarray, np.ndarray],
) -> bool:
    """Fit so many parameters of a lens, in place, and write residuals and derivatives."""
    e, rows = left
    unit, middle = picture
    spread = np.array([_CENTRE * unit, _CENTRE * unit, _TERMS[0], _TERMS[1], _TERMS[2]])
    beyond = np.concatenate((middle, np.zeros(RADIAL)))
    normal, change, damping = np.empty((ALL, ALL)), np.zeros(ALL), _BEGIN
    better, new_e, new_rows = lens.copy(), np.empty_like(e), np.empty_like(rows)
    if not _linearised(lens, corners, unit, (e, rows)):
        return False
    for _ in range(_STEPS):
        sigma = _sigma(e)
        cost = _cost(e, sigma) + (((lens[HOMOGRAPHY:] - beyond) / spread) ** 2).sum()
        right = _write_normal(normal, (e, rows), sigma, free)
        for i in range(HOMOGRAPHY, free):
            per = spread[i - HOMOGRAPHY] ** -2
            normal[i, i] += per
            right[i] += per * (beyond[i - HOMOGRAPHY] - lens[i])
        found = False
        while not found and damping < _MOST_DAMPED:
            factor = normal.copy()
            for i in range(free):
                factor[i, i] += (damping + _RIDGE) * normal[i, i] + _RIDGE
            change[:free] = right[:free]
            if factorise(factor, free, _SINGULAR):
                solve(factor, change[:free])
                better[:] = lens + change
                if _linearised(better, corners, unit, (new_e, new_rows)):
                    prior = (((better[HOMOGRAPHY:] - beyond) / spread) ** 2).sum()
                    found = _cost(new_e, sigma) + prior <= cost
            damping *= _LESS if found else _MORE
        if not found:
            return True
        moved = _moved(rows, change)
        lens[:], e[:], rows[:] = better, new_e, new_rows
        if moved < _CONVERGED:
            return True
    return True


@compiled
def _linearised(lens: np.ndarray, corners: Corners, unit: float, left: tuple[np.ndarray, np.ndarray]) -> bool:
    """Write residuals in the picture (n, 2), px, and their derivatives; tell whether all are in front."""
    board, q = corners
    e, rows = left
    a, b, c = lens[HOMOGRAPHY + 2], lens[HOMOGRAPHY + 3], lens[HOMOGRAPHY + 4]
    first_depth = first_det = 0.0
    by_x, by_y, one = np.empty(3), np.empty(3), np.empty(3)
    for k in range(len(q)):
        x, y = (q[k, 0] - lens[HOMOGRAPHY]) / unit, (q[k, 1] - lens[HOMOGRAPHY + 1]) / unit
        square = x * x + y * y
        one[0], one[1], one[2] = x, y, 1.0 + square * (a + square * (b + square * c))
        slope = 2.0 * (a + square * (2.0 * b + square * 3.0 * c))
        X, Y, Z = 0.0, 0.0, 0.0
        for i in range(3):
            X, Y, Z = X + lens[i] * one[i], Y + lens[3 + i] * one[i], Z + lens[6 + i] * one[i]
        for row in range(3):
            by_x[row] = (lens[3 * row] + lens[3 * row + 2] * slope * x) / unit
            by_y[row] = (lens[3 * row + 1] + lens[3 * row + 2] * slope * y) / unit
        u, v = X / Z, Y / Z
        ux, uy, vx, vy = (
            by_x[0] - u * by_x[2],
            by_y[0] - u * by_y[2],
            by_x[1] - v * by_x[2],
            by_y[1] - v * by_y[2],
        )
        det = ux * vy - uy * vx
        if k == 0:
            first_depth, first_det = Z, det
        if not (Z * first_depth > 0.0 and det * first_det > 0.0):
            return False
        # All are divided by the depth, and with it by the slopes: the picture's own residuals.
        xu, xv, yu, yv = vy / det, -uy / det, -vx / det, ux / det
        du, dv = Z * (board[k, 0] - u), Z * (board[k, 1] - v)
        e[k, 0], e[k, 1] = xu * du + xv * dv, yu * du + yv * dv
        own = rows[k]
        for i in range(3):
            own[0, i], own[1, i] = xu * one[i], yu * one[i]
            own[0, 3 + i], own[1, 3 + i] = xv * one[i], yv * one[i]
            own[0, 6 + i] = -(u * xu + v * xv) * one[i]
            own[1, 6 + i] = -(u * yu + v * yv) * one[i]
        own[0, HOMOGRAPHY], own[0, HOMOGRAPHY + 1] = -1.0, 0.0
        own[1, HOMOGRAPHY], own[1, HOMOGRAPHY + 1] = 0.0, -1.0
        tu, tv, power = lens[2] - u * lens[8], lens[5] - v * lens[8], square
        for i in range(HOMOGRAPHY + 2, ALL):
            own[0, i], own[1, i] = (xu * tu + xv * tv) * power, (yu * tu + yv * tv) * power
            power *= square
    return bool(np.isfinite(e).all())


@compiled
def _write_normal(
    normal: np.ndarray, left: tuple[np.ndarray, np.ndarray], sigma: float, free: int
) -> np.ndarray:
    """Write the lower triangle of the weighted normal matrix; return the right side, shape (14,)."""
    e, rows = left
    right = np.zeros(ALL)
    normal[:] = 0.0
    for k in range(len(e)):
        weight = _weight(e[k], sigma) / sigma**2
        for axis in range(2):
            own = rows[k, axis]
            for i in range(free):
                scaled = weight * own[i]
                right[i] += scaled * e[k, axis]
                for j in range(i + 1):
                    normal[i, j] += scaled * own[j]
    return right


@compiled
def _moved(rows: np.ndarray, change: np.ndarray) -> float:
    """Return the farthest move of a corner along an axis by changed parameters, px."""
    most = 0.0
    for k in range(len(rows)):
        for axis in range(2):
            moved = 0.0
            for i in range(ALL):
                moved += rows[k, axis, i] * change[i]
            most = max(most, abs(moved))
    return most


@compiled
def _sigma(e: np.ndarray) -> float:
    """Return the usual error of residuals (n, 2) along an axis, px."""
    squares = np.sort(e[:, 0] ** 2 + e[:, 1] ** 2)
    return max(sqrt(_MEDIAN * squares[len(squares) // 2]), _LEAST_SIGMA)


@compiled
def _weight(e: np.ndarray, sigma: float) -> float:
    """Return the weight of a residual, shape (2,)."""
    weight: float = (_HEAVY + 2.0) / (_HEAVY + (e[0] * e[0] + e[1] * e[1]) / sigma**2)
    return weight


@compiled
def _cost(e: np.ndarray, sigma: float) -> float:
    """Return twice the negative logarithm of the likelihood of residuals (n, 2)."""
    total = 0.0
    for k in range(len(e)):
        total += (_HEAVY + 2.0) * np.log1p((e[k, 0] ** 2 + e[k, 1] ** 2) / (_HEAVY * sigma**2))
    return total
