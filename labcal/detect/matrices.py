"""Stacks of 2 x 2 matrices as :mod:`labcal.geometry.two_by_two` has them, compiled.

Of the some hundred dots of a picture NumPy's calls take longer than the sums: these are the same sums.
"""

from math import sqrt

import numpy as np

from labcal.detect.compiled import compiled


@compiled
def inverses(M: np.ndarray) -> np.ndarray:
    """Return the inverses of matrices, shape (n, 2, 2), that have one."""
    found = np.empty((len(M), 2, 2))
    for k in range(len(M)):
        determinant = M[k, 0, 0] * M[k, 1, 1] - M[k, 0, 1] * M[k, 1, 0]
        found[k, 0, 0], found[k, 1, 1] = M[k, 1, 1] / determinant, M[k, 0, 0] / determinant
        found[k, 0, 1], found[k, 1, 0] = -M[k, 0, 1] / determinant, -M[k, 1, 0] / determinant
    return found


@compiled
def matrix_roots(M: np.ndarray) -> np.ndarray:
    """Return the symmetric square roots of symmetric positive matrices, shape (n, 2, 2)."""
    found = np.empty((len(M), 2, 2))
    for k in range(len(M)):
        root = sqrt(M[k, 0, 0] * M[k, 1, 1] - M[k, 0, 1] * M[k, 1, 0])
        scale = sqrt(M[k, 0, 0] + M[k, 1, 1] + 2.0 * root)
        found[k, 0, 0], found[k, 1, 1] = (M[k, 0, 0] + root) / scale, (M[k, 1, 1] + root) / scale
        found[k, 0, 1], found[k, 1, 0] = M[k, 0, 1] / scale, M[k, 1, 0] / scale
    return found


@compiled
def eigenvalues(M: np.ndarray) -> np.ndarray:
    """Return the eigenvalues (n, 2), the smaller first, of matrices (n, 2, 2) whose eigenvalues are real."""
    found = np.empty((len(M), 2))
    for k in range(len(M)):
        middle, half = 0.5 * (M[k, 0, 0] + M[k, 1, 1]), 0.5 * (M[k, 0, 0] - M[k, 1, 1])
        squared = half**2 + M[k, 0, 1] * M[k, 1, 0]
        apart = sqrt(max(squared, 0.0))
        found[k, 0], found[k, 1] = middle - apart, middle + apart
    return found


@compiled
def mean_radii(M: np.ndarray) -> np.ndarray:
    """Return the geometric means of the semi-axes of outlines with matrices (n, 2, 2), px."""
    found = np.empty(len(M))
    for k in range(len(M)):
        found[k] = sqrt(sqrt(M[k, 0, 0] * M[k, 1, 1] - M[k, 0, 1] * M[k, 1, 0]))
    return found


@compiled
def geometric_means(A: np.ndarray, B: np.ndarray) -> np.ndarray:
    """Return the geometric means of positive symmetric matrices (n, 2, 2) (Bhatia 2007, chapter 4)."""
    found = np.empty((len(A), 2, 2))
    total = np.empty((2, 2))
    for k in range(len(A)):
        alpha = sqrt(A[k, 0, 0] * A[k, 1, 1] - A[k, 0, 1] * A[k, 1, 0])
        beta = sqrt(B[k, 0, 0] * B[k, 1, 1] - B[k, 0, 1] * B[k, 1, 0])
        for i in range(2):
            for j in range(2):
                total[i, j] = A[k, i, j] / alpha + B[k, i, j] / beta
        scale = sqrt(alpha * beta / (total[0, 0] * total[1, 1] - total[0, 1] * total[1, 0]))
        for i in range(2):
            for j in range(2):
                found[k, i, j] = scale * total[i, j]
    return found


@compiled
def mapped(maps: np.ndarray, shapes: np.ndarray) -> np.ndarray:
    """Return ``A S A'`` of maps A and shapes S, (n, 2, 2) or, of one of them, (1, 2, 2) if all are one."""
    count = len(maps) if len(shapes) == 1 else len(shapes)
    found, half = np.empty((count, 2, 2)), np.empty((2, 2))
    for k in range(count):
        A, S = maps[k if len(maps) > 1 else 0], shapes[k if len(shapes) > 1 else 0]
        for i in range(2):
            for j in range(2):
                half[i, j] = A[i, 0] * S[0, j] + A[i, 1] * S[1, j]
        for i in range(2):
            for j in range(2):
                found[k, i, j] = half[i, 0] * A[j, 0] + half[i, 1] * A[j, 1]
    return found


@compiled
def inside(centre: np.ndarray, shape: np.ndarray, size: tuple[int, int], margin: float) -> np.ndarray:
    """Tell which outlines (n, 2), (n, 2, 2) lie whole in a picture (width, height), up to a margin, px."""
    found = np.empty(len(centre), dtype=np.bool_)
    for k in range(len(centre)):
        whole = True
        for axis in range(2):
            extent = sqrt(shape[k, axis, axis])
            whole &= centre[k, axis] - extent > -margin
            whole &= centre[k, axis] + extent < size[axis] - 1 + margin
        found[k] = whole
    return found
