"""Small symmetric systems, compiled."""

from math import sqrt

import numpy as np

from labcal.detect.compiled import compiled


@compiled
def factorise(matrix: np.ndarray, n: int, least: float) -> bool:
    """Replace a matrix's lower triangle by its Cholesky factor.

    False where a pivot falls to `least` of its diagonal entry: there is none, or the system is singular.
    """
    for j in range(n):
        pivot = matrix[j, j]
        for k in range(j):
            pivot -= matrix[j, k] * matrix[j, k]
        if not pivot > least * matrix[j, j]:
            return False
        root = sqrt(pivot)
        matrix[j, j] = root
        for i in range(j + 1, n):
            total = matrix[i, j]
            for k in range(j):
                total -= matrix[i, k] * matrix[j, k]
            matrix[i, j] = total / root
    return True


@compiled
def solve(factor: np.ndarray, right: np.ndarray) -> None:
    """Solve with a Cholesky factor, in place; as many equations as `right` is long."""
    n = len(right)
    # What is solved is taken from all others at once: none of these waits for another.
    for i in range(n):
        right[i] /= factor[i, i]
        solved = right[i]
        for k in range(i + 1, n):
            right[k] -= factor[k, i] * solved
    for i in range(n - 1, -1, -1):
        right[i] /= factor[i, i]
        solved = right[i]
        for k in range(i):
            right[k] -= factor[i, k] * solved
