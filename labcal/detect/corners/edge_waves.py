"""Residuals along the edges of a chessboard's corner, in waves that a fit leaves free."""

import numpy as np
from jaxtyping import Float64

from labcal.detect.corners.corner_model import LinearisedCorner

WAVES = 6
"""Of the distance from the corner: one half to three within the pixels of a fit."""


def edge_powers(
    linear: LinearisedCorner,
    offset: Float64[np.ndarray, "2 n"],
    gain: Float64[np.ndarray, "2 n"],
    variance: Float64[np.ndarray, " n"],
) -> Float64[np.ndarray, "waves 2"]:
    """Return the power of the residuals in each wave, and the expected one, for noise as the fit has it.

    The corner that is stated is a sum of pixels with weights of opposite sign on opposite sides of it. The
    residuals are summed with the same weights times waves of the distance from the corner, which keep that
    symmetry: what is alike on opposite sides, as are markers, blur and a tone curve, cancels, as it does in
    the corner's place. The waves are cosines, so that the sums are independent of each other.

    Parameters
    ----------
    linear : LinearisedCorner
        At the converged fit.
    offset : ndarray, shape (2, n)
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
    distance = np.hypot(offset[0], offset[1])
    number = np.arange(1, WAVES + 1)
    waves = np.cos(np.pi * number[:, None] * distance / distance.max())
    tests = (waves[:, None] * gain).reshape(2 * WAVES, -1)
    size = (tests**2 * variance).sum(axis=1)
    basis, _ = np.linalg.qr(linear.jacobian.T)
    free = tests - (tests @ basis) @ basis.T
    seen = (free @ linear.residual) ** 2 / size
    expected = (free**2 * variance).sum(axis=1) / size
    powers: Float64[np.ndarray, "tests 2"] = np.stack([seen, expected], axis=1)
    return np.asarray(powers.reshape(WAVES, 2, 2).mean(axis=1))


def wavelengths(reach: float) -> Float64[np.ndarray, " waves"]:
    """Return the lengths of the waves, px, of a fit to pixels up to so far from the corner."""
    return 2.0 * reach / np.arange(1, WAVES + 1)
