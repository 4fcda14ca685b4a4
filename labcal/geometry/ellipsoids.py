"""Confidence ellipsoids of covariances."""

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask
from labcal.distributions import chi2_quantile
from labcal.geometry.covariances import positive_definite


def within_ellipsoids(
    error: Float64[np.ndarray, "n dim"], covariance: Float64[np.ndarray, "n dim dim"], confidence: float
) -> Mask:
    """Return a mask of errors that lie inside the confidence ellipsoids of normal errors.

    Parameters
    ----------
    error : ndarray, shape (n, d)
        Predicted minus true.
    covariance : ndarray, shape (n, d, d)
        As stated, in the unit of the errors squared.
    confidence : float
        The share.

    Returns
    -------
    ndarray of bool, shape (n,)
        False for errors that are not finite, and for covariances that cannot be inverted.
    """
    stated = positive_definite(covariance) & np.isfinite(error).all(axis=1)
    whitened = np.linalg.solve(covariance[stated], error[stated, :, None])[..., 0]
    within = np.zeros(len(error), dtype=bool)
    within[stated] = (error[stated] * whitened).sum(axis=1) <= chi2_quantile(confidence, error.shape[1])
    return within
