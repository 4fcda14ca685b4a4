"""Covariances, which may come from a file."""

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask


def positive_definite(covariance: Float64[np.ndarray, "*batch dim dim"]) -> Mask:
    """Return which covariances can be inverted: finite, and with a positive variance in every direction.

    Parameters
    ----------
    covariance : ndarray, shape (..., d, d)
        Symmetric, in any unit.

    Returns
    -------
    ndarray of bool, shape (...)
    """
    finite = np.isfinite(covariance).all(axis=(-2, -1))
    safe = np.where(finite[..., None, None], covariance, np.eye(covariance.shape[-1]))
    spread = np.linalg.eigvalsh(safe)
    return np.asarray(finite & (spread[..., 0] > 1e-14 * spread[..., -1]))
