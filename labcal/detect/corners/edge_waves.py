"""Residuals along the edges of a chessboard's corner, in waves that a fit leaves free."""

from math import cos, pi

import numpy as np
from jaxtyping import Float64

from labcal.detect.cholesky import solve
from labcal.detect.compiled import compiled
from labcal.detect.row_products import LANES, add_products, copy_columns, filled_up

WAVES = 6
"""Of the distance from the corner: one half to three within the pixels of a fit."""
_TESTS, _ROWS = 2 * WAVES, 12
"""Waves along both axes; rows of the derivatives and, below them, the residuals: whole tiles of products."""


@compiled
def wave_powers(
    fit: tuple[np.ndarray, np.ndarray, np.ndarray],
    distance: np.ndarray,
    gain: np.ndarray,
    variance: np.ndarray,
) -> np.ndarray:
    """Return the power of the residuals in each wave, and the expected one, for noise as the fit has it.

    The corner that is stated is a sum of pixels with weights of opposite sign on opposite sides of it. The
    residuals are summed with the same weights times waves of the distance from the corner, which keep that
    symmetry: what is alike on opposite sides, as are markers, blur and a tone curve, cancels, as it does in
    the corner's place. The waves are cosines, so that the sums are independent of each other.

    Parameters
    ----------
    fit : tuple of ndarray
        At the converged fit: residuals (n,), derivatives (p, n), and the Cholesky factor of the normal
        matrix (p, p).
    distance : ndarray, shape (n,)
        Of the pixels from the corner, px.
    gain : ndarray, shape (2, n)
        Weights of the residuals in the corner's place.
    variance : ndarray, shape (n,)
        Of the pixels' noise, as the covariance counts with it.

    Returns
    -------
    ndarray, shape (WAVES, 2)
        Means over both axes; for weights whose noise has the power 1 where a fit takes none of it.
    """
    residual, jacobian, factor = fit
    n, free = len(residual), len(jacobian)
    width = filled_up(n)
    # Waves, then derivatives and residuals, filled up to whole tiles of products.
    waves, rows = np.zeros((_TESTS, width)), np.zeros((_ROWS, width))
    copy_columns(jacobian, 0, rows, (0, n))
    rows[free, :n] = residual
    per_farthest = pi / distance.max()
    for k in range(n):
        # By Chebyshev's recursion, each wave from the two before it.
        first = cos(per_farthest * distance[k])
        before, wave = 1.0, first
        for number in range(WAVES):
            waves[2 * number, k], waves[2 * number + 1, k] = wave * gain[0, k], wave * gain[1, k]
            before, wave = wave, 2.0 * first * wave - before
    taken = np.zeros((_TESTS, _ROWS))
    add_products(waves, rows, (0, width), taken)
    sizes = _weighted_squares(waves, variance)
    powers, weight = np.zeros((WAVES, 2)), np.empty(free)
    for test in range(_TESTS):
        weight[:] = taken[test, :free]
        solve(factor, weight)
        for p in range(free):
            row, own, by = rows[p], waves[test], weight[p]
            for k in range(n):
                own[k] -= by * row[k]
    left = np.zeros((_TESTS, _ROWS))
    add_products(waves, rows, (0, width), left)
    expected = _weighted_squares(waves, variance)
    for test in range(_TESTS):
        powers[test // 2, 0] += 0.5 * left[test, free] ** 2 / sizes[test]
        powers[test // 2, 1] += 0.5 * expected[test] / sizes[test]
    return powers


@compiled
def _weighted_squares(rows: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Return the sums of the squares of rows (m, n), weighted (n,); four at a time, since a sum must wait."""
    sums = np.zeros(len(rows))
    for i in range(0, len(rows), LANES):
        a = b = c = d = 0.0
        for k in range(len(weight)):
            a += rows[i, k] * rows[i, k] * weight[k]
            b += rows[i + 1, k] * rows[i + 1, k] * weight[k]
            c += rows[i + 2, k] * rows[i + 2, k] * weight[k]
            d += rows[i + 3, k] * rows[i + 3, k] * weight[k]
        sums[i], sums[i + 1], sums[i + 2], sums[i + 3] = a, b, c, d
    return sums


def wavelengths(reach: float) -> Float64[np.ndarray, " waves"]:
    """Return the lengths of the waves, px, of a fit to pixels up to so far from the corner."""
    return 2.0 * reach / np.arange(1, WAVES + 1)
