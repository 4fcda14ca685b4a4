"""Distance of a whole grid's spots from one smooth surface of its nodes, by normal equations, compiled."""

from math import sqrt

import numpy as np

from labcal.detect.cholesky import factorise, solve
from labcal.detect.compiled import compiled

_ENTRIES = 9
"""Of a homography."""
_SINGULAR = 1e-11
_AT_ZERO = 1e-13
"""Added to the diagonal, of its mean: the least eigenvalue of exact data is zero."""
_ROUNDS = 6
_SETTLED = 1e-9
"""Of a vector of unit length, which the last round moved by less."""


@compiled
def off_smooth_surface(nodes: np.ndarray, seen: np.ndarray, degree: int) -> float:
    """Return the largest distance from a polynomial of the nodes under a homography, in the nodes' unit.

    NaN where the normal equations do not tell: what determines a map badly, they do not determine at all.

    Parameters
    ----------
    nodes : ndarray, shape (n, 2)
        About a middle, of extent 1.
    seen : ndarray, shape (n, 2)
        Where their spots are, px.
    degree : int
        Of the polynomial, which follows what a homography leaves.
    """
    count = len(nodes)
    source, target = _normalised(seen), _normalised(nodes)
    entries = _homography(source, target)
    if not np.isfinite(entries[0]):
        return np.nan
    scale, middle = _similarity(nodes)
    straight = np.empty((count, 2))
    side = 0.0
    for k in range(count):
        x, y = source[k, 0], source[k, 1]
        depth = entries[6] * x + entries[7] * y + entries[8]
        if k == 0:
            side = depth
        if not depth * side > 0.0:
            return np.nan
        for axis in range(2):
            along = entries[3 * axis] * x + entries[3 * axis + 1] * y + entries[3 * axis + 2]
            straight[k, axis] = along / depth / scale + middle[axis]
    return _off_polynomial(nodes, straight, degree)


@compiled
def _similarity(points: np.ndarray) -> tuple[float, np.ndarray]:
    """Return the scale after which points have the root mean square distance sqrt(2), and their middle."""
    middle = np.array([points[:, 0].mean(), points[:, 1].mean()])
    squares = ((points[:, 0] - middle[0]) ** 2 + (points[:, 1] - middle[1]) ** 2).sum()
    return sqrt(2.0 * len(points) / squares), middle


@compiled
def _normalised(points: np.ndarray) -> np.ndarray:
    """Return points about their middle, with the root mean square distance sqrt(2)."""
    scale, middle = _similarity(points)
    found: np.ndarray = (points - middle) * scale
    return found


@compiled
def _homography(source: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Return the entries of a homography, row by row, by inverse iteration; NaN where none is determined."""
    normal, row = np.zeros((_ENTRIES, _ENTRIES)), np.zeros(_ENTRIES)
    for k in range(len(source)):
        for axis in range(2):
            row[:] = 0.0
            row[3 * axis], row[3 * axis + 1], row[3 * axis + 2] = source[k, 0], source[k, 1], 1.0
            for j in range(3):
                row[6 + j] = -target[k, axis] * row[3 * axis + j]
            for i in range(_ENTRIES):
                for j in range(i + 1):
                    normal[i, j] += row[i] * row[j]
    added = _AT_ZERO * np.trace(normal) / _ENTRIES
    for i in range(_ENTRIES):
        normal[i, i] += added
    found = np.full(_ENTRIES, 1.0 / 3.0)
    if factorise(normal, _ENTRIES, 0.0):
        for _ in range(_ROUNDS):
            before = found.copy()
            solve(normal, found)
            found /= sqrt((found**2).sum())
            moved = min(((found - before) ** 2).sum(), ((found + before) ** 2).sum())
            if moved < _SETTLED**2:
                return found
    return np.full(_ENTRIES, np.nan)


@compiled
def _off_polynomial(nodes: np.ndarray, values: np.ndarray, degree: int) -> float:
    """Return the largest distance of values (n, 2) from a polynomial of nodes; NaN if nothing fits."""
    count, terms = len(nodes), (degree + 1) * (degree + 2) // 2
    design, normal, right = np.empty((count, terms)), np.zeros((terms, terms)), np.zeros((2, terms))
    for k in range(count):
        term, power = 0, 1.0
        for i in range(degree + 1):
            product = power
            for _ in range(degree + 1 - i):
                design[k, term] = product
                product *= nodes[k, 1]
                term += 1
            power *= nodes[k, 0]
        for i in range(terms):
            right[0, i] += design[k, i] * values[k, 0]
            right[1, i] += design[k, i] * values[k, 1]
            for j in range(i + 1):
                normal[i, j] += design[k, i] * design[k, j]
    if not factorise(normal, terms, _SINGULAR):
        return np.nan
    solve(normal, right[0])
    solve(normal, right[1])
    most = 0.0
    for k in range(count):
        x, y = values[k, 0], values[k, 1]
        for i in range(terms):
            x -= right[0, i] * design[k, i]
            y -= right[1, i] * design[k, i]
        most = max(most, x * x + y * y)
    return sqrt(most)
