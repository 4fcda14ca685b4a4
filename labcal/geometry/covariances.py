"""Checks of covariances that may come from a file."""

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


def valid_or_not_stated(covariance: Float64[np.ndarray, "n dim dim"], most: float) -> Mask:
    """Return a mask of covariances that are not stated (all NaN), or whose variances are within bounds.

    Parameters
    ----------
    covariance : ndarray, shape (n, d, d)
        Symmetric, in any unit.
    most : float
        Bound of a variance, in the same unit.

    Returns
    -------
    ndarray of bool, shape (n,)
        Zero variances count as some: what is exact by decree has them.
    """
    left_open = np.isnan(covariance).all(axis=(1, 2))
    finite = np.isfinite(covariance).all(axis=(1, 2))
    largest = np.abs(np.where(finite[:, None, None], covariance, 0.0)).max(axis=(1, 2), initial=0.0)
    safe = np.where((finite & (largest <= most))[:, None, None], covariance, 0.0)
    least = np.linalg.eigvalsh(safe)[:, 0]
    return np.asarray(left_open | (finite & (largest <= most) & (least >= -1e-9 * largest)))


def covariance_root(covariance: Float64[np.ndarray, "dim dim"]) -> Float64[np.ndarray, "dim dim"]:
    """Return a matrix whose product with its transpose is a covariance, which may be singular.

    Parameters
    ----------
    covariance : ndarray, shape (d, d)
        Symmetric; of quantities of any units, whose sizes may differ by many orders.

    Returns
    -------
    ndarray, shape (d, d)
    """
    sigma = np.sqrt(np.maximum(np.diagonal(covariance), 0.0))
    scale = np.where(sigma > 0.0, sigma, 1.0)
    spread, directions = np.linalg.eigh(covariance / scale[:, None] / scale)
    return np.asarray(scale[:, None] * directions * np.sqrt(np.maximum(spread, 0.0)))
