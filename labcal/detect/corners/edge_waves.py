"""Residuals along the edges of a chessboard's corner, in waves that a fit leaves free."""

from math import factorial, pi

import numpy as np
from jaxtyping import Float64

from labcal.detect.cholesky import solve
from labcal.detect.compiled import compiled
from labcal.detect.row_products import HIGH, WIDE, add_products

WAVES = 6
"""Of the distance from the corner: one half to three within the pixels of a fit."""
_TESTS = 2 * WAVES
"""Waves along both axes."""
ROWS, RESIDUAL = 12, 10
"""Of a chessboard's table of derivatives and residuals: whole tiles of products, residuals last but one."""
_TAYLOR = tuple((-1.0) ** k / factorial(2 * k + 1) for k in range(9))
"""Of the sine, over its argument, by powers of the argument squared."""


@compiled
def wave_powers(
    tables: tuple[np.ndarray, np.ndarray],
    products: tuple[np.ndarray, np.ndarray, np.ndarray],
    free: int,
    far: tuple[np.ndarray, float],
    variance: np.ndarray,
) -> np.ndarray:
    """Return the power of the residuals in each wave, and the expected one, for noise as the fit has it.

    The corner that is stated is a sum of pixels with weights of opposite sign on opposite sides of it. The
    residuals are summed with the same weights times waves of the distance from the corner, which keep that
    symmetry: what is alike on opposite sides, as are markers, blur and a tone curve, cancels, as it does in
    the corner's place. The waves are cosines, so that the sums are independent of each other.

    Parameters
    ----------
    tables : (ndarray, ndarray), shape (r, w)
        At the converged fit: derivatives by the free parameters, and in the last row but one residuals; 0
        in all other rows, and in all columns beyond the n pixels. r is even, w is n filled up to whole tiles.
        And the derivatives, filled up to an even number of rows, times the variances.
    products : (ndarray, ndarray, ndarray)
        Of the first table's rows with one another, its lower triangle; the Cholesky factor of the normal
        matrix, which is a part of it with what is known from elsewhere added; and of the derivatives with
        those of the second table.
    free : int
        Number of free parameters.
    far : (ndarray, float)
        Distances of the pixels from the corner, shape (n,), and the greatest one, px.
    variance : ndarray, shape (n,)
        Of the pixels' noise, as the covariance counts with it.

    Returns
    -------
    ndarray, shape (WAVES, 2)
        Means over both axes; for weights whose noise has the power 1 where a fit takes none of it.
    """
    (table, weighted), (plain, root, fits), (distance, farthest) = tables, products, far
    n, even, (size, width) = len(distance), len(weighted), table.shape
    residual = size - 2
    gain = np.zeros((2, width))
    for axis in range(2):
        weight = np.zeros(free)
        weight[axis] = 1.0
        solve(root, weight)
        for p in range(free):
            row, by, out = table[p], weight[p], gain[axis]
            for k in range(n):
                out[k] += by * row[k]
    waves = np.zeros((_TESTS, width))
    _write_waves(distance, 1.0 / farthest, gain, waves)
    sizes = _weighted_squares(waves, variance)
    # Of a wave t less what the fit takes, t - J' w, the squares times the variances v are
    # t v t - 2 w (J v t) + w (J v J') w.
    taken, noise, left = np.zeros((_TESTS, even)), np.zeros((_TESTS, even)), np.zeros((_TESTS, WIDE))
    add_products(waves, table[:even], (0, width), taken)
    add_products(waves, table[residual:], (0, width), left)
    add_products(waves, weighted, (0, width), noise)
    powers, weight = np.zeros((WAVES, 2)), np.empty(free)
    for test in range(_TESTS):
        for p in range(free):
            weight[p] = taken[test, p]
        solve(root, weight)
        seen, expected = left[test, 0], sizes[test]
        for p in range(free):
            seen -= weight[p] * plain[residual, p]
            along = -2.0 * noise[test, p]
            for q in range(free):
                along += fits[p, q] * weight[q]
            expected += weight[p] * along
        powers[test // 2, 0] += 0.5 * seen * seen / sizes[test]
        powers[test // 2, 1] += 0.5 * max(expected, 0.0) / sizes[test]
    return powers


@compiled
def _write_waves(distance: np.ndarray, per_farthest: float, gain: np.ndarray, waves: np.ndarray) -> None:
    """Write the weights of both axes (2, w) times each wave, by Chebyshev's recursion."""
    n = len(distance)
    first, before, wave, following = np.empty(n), np.ones(n), np.empty(n), np.empty(n)
    for k in range(n):
        first[k] = _half_wave(per_farthest * distance[k])
    for k in range(n):
        wave[k] = first[k]
    for number in range(WAVES):
        for axis in range(2):
            row, own = waves[2 * number + axis], gain[axis]
            for k in range(n):
                row[k] = wave[k] * own[k]
        for k in range(n):
            following[k] = 2.0 * first[k] * wave[k] - before[k]
        before, wave, following = wave, following, before


@compiled
def _half_wave(share: float) -> float:
    """Return ``cos(pi share)`` for shares from 0 to 1, by Taylor's series of the sine; right to 1e-12."""
    x = pi * (0.5 - share)
    y = x * x
    high = _TAYLOR[4] + y * (_TAYLOR[5] + y * (_TAYLOR[6] + y * (_TAYLOR[7] + y * _TAYLOR[8])))
    return float(x * (_TAYLOR[0] + y * (_TAYLOR[1] + y * (_TAYLOR[2] + y * (_TAYLOR[3] + y * high)))))


@compiled
def _weighted_squares(rows: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Return the sums of the squares of rows (m, w), weighted (n,); 0 in all columns beyond these."""
    count, n = len(rows), len(weight)
    sums, products, weighted = np.empty(count), np.empty((HIGH, WIDE)), np.zeros((WIDE, rows.shape[1]))
    for i in range(0, count, WIDE):
        for j in range(WIDE):
            row, out = rows[i + j], weighted[j]
            for k in range(n):
                out[k] = row[k] * weight[k]
        products[:] = 0.0
        add_products(rows[i : i + HIGH], weighted, (0, rows.shape[1]), products)
        for j in range(WIDE):
            sums[i + j] = products[j, j]
    return sums


def wavelengths(reach: float) -> Float64[np.ndarray, " waves"]:
    """Return the lengths of the waves, px, of a fit to pixels up to so far from the corner."""
    return 2.0 * reach / np.arange(1, WAVES + 1)
