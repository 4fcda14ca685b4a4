"""Residuals along the edges of a chessboard's corner, in waves that a fit leaves free."""

from math import cos, pi

import numpy as np
from jaxtyping import Float64

from labcal.detect.cholesky import solve
from labcal.detect.compiled import compiled

WAVES = 6
"""Of the distance from the corner: one half to three within the pixels of a fit."""


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
    n = len(residual)
    farthest = distance.max()
    tests = np.empty((2 * WAVES, n))
    for k in range(n):
        # By Chebyshev's recursion, each wave from the two before it.
        first = cos(pi * distance[k] / farthest)
        before, wave = 1.0, first
        for number in range(WAVES):
            for axis in range(2):
                tests[2 * number + axis, k] = wave * gain[axis, k]
            before, wave = wave, 2.0 * first * wave - before
    taken = tests @ jacobian.T
    for test in range(2 * WAVES):
        solve(factor, taken[test])
    left = tests - taken @ jacobian
    powers = np.zeros((WAVES, 2))
    for test in range(2 * WAVES):
        size = seen = expected = 0.0
        for k in range(n):
            size += tests[test, k] * tests[test, k] * variance[k]
            seen += left[test, k] * residual[k]
            expected += left[test, k] * left[test, k] * variance[k]
        powers[test // 2, 0] += 0.5 * seen * seen / size
        powers[test // 2, 1] += 0.5 * expected / size
    return powers


def wavelengths(reach: float) -> Float64[np.ndarray, " waves"]:
    """Return the lengths of the waves, px, of a fit to pixels up to so far from the corner."""
    return 2.0 * reach / np.arange(1, WAVES + 1)
