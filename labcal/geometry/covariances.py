"""Checks of covariances that may come from a file."""

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask

_CLEARLY = 1e-10
"""Share of the trace that is far from rounding, and far below any covariance that is measured with."""


def clearly_definite(symmetric: Float64[np.ndarray, "*batch dim dim"], least: float) -> Mask:
    """Return which matrices have all eigenvalues above a share of their trace, by a bound that may miss some.

    Eigenvalues of a million small matrices take seconds, determinants a fraction of that. Whoever needs the
    rest looks at the eigenvalues of those that are left.

    Parameters
    ----------
    symmetric : ndarray, shape (..., d, d)
        Of two or three dimensions.
    least : float
        Share of the trace; far above the rounding of a determinant, 1e-12 or more.

    Returns
    -------
    ndarray of bool, shape (...)
        False where not clearly so, and of matrices that are not finite.

    Notes
    -----
    With positive leading minors all eigenvalues are positive (Sylvester), and the least one is not less than
    the determinant over the largest product of the others, which is below the trace, or a quarter of its
    square. The least minor of two dimensions is held against its own trace, so that rounding decides nothing.
    """
    A = np.moveaxis(symmetric, (-2, -1), (0, 1))
    with np.errstate(invalid="ignore", over="ignore"):
        minor = A[0, 0] * A[1, 1] - A[1, 0] * A[1, 0]
        trace = A[0, 0] + A[1, 1]
        definite = (A[0, 0] > 0.0) & (minor > least * trace * trace)
        if len(A) > 2:  # noqa: PLR2004 -- of three dimensions
            determinant = (
                A[2, 0] * (A[1, 0] * A[2, 1] - A[1, 1] * A[2, 0])
                - A[2, 1] * (A[0, 0] * A[2, 1] - A[1, 0] * A[2, 0])
                + A[2, 2] * minor
            )
            trace = trace + A[2, 2]
            definite &= determinant > least * trace * trace * trace
        return np.asarray(definite & np.isfinite(trace))


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
    found = clearly_definite(covariance, _CLEARLY)
    rest = covariance[~found]
    finite = np.isfinite(rest).all(axis=(-2, -1))
    spread = np.linalg.eigvalsh(np.where(finite[:, None, None], rest, np.eye(covariance.shape[-1])))
    found[~found] = finite & (spread[:, 0] > 1e-14 * spread[:, -1])
    return found


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
    found = clearly_definite(covariance, _CLEARLY)
    found &= np.abs(covariance).max(axis=(1, 2), initial=0.0) <= most
    rest = covariance[~found]
    left_open = np.isnan(rest).all(axis=(1, 2))
    finite = np.isfinite(rest).all(axis=(1, 2))
    largest = np.abs(np.where(finite[:, None, None], rest, 0.0)).max(axis=(1, 2), initial=0.0)
    safe = np.where((finite & (largest <= most))[:, None, None], rest, 0.0)
    least = np.linalg.eigvalsh(safe)[:, 0]
    found[~found] = left_open | (finite & (largest <= most) & (least >= -1e-9 * largest))
    return found


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


def inverses(covariance: Float64[np.ndarray, "*batch dim dim"]) -> Float64[np.ndarray, "*batch dim dim"]:
    """Return the inverses of covariances; that of many equal ones, as a stated noise gives, once.

    Parameters
    ----------
    covariance : ndarray, shape (..., d, d)
        All of them can be inverted.
    """
    if covariance.size:
        first = covariance.reshape(-1, *covariance.shape[-2:])[0]
        if (covariance == first).all():
            return np.broadcast_to(np.linalg.inv(first), covariance.shape).copy()
    return np.asarray(np.linalg.inv(covariance))
