"""Statistics of 3-D errors."""

from dataclasses import dataclass

import numpy as np

from labcal.arrays import AnyArray, float_array
from labcal.geometry.covariances import positive_definite
from labcal.geometry.ellipsoids import within_ellipsoids

CONFIDENCE = 0.95


@dataclass(frozen=True)
class ErrorStatistics:
    """Errors of n points, predicted minus true, mm."""

    n: int
    mean_signed_mm: tuple[float, float, float]
    """Mean error in x, y and z, with its sign."""
    mae_mm: float
    """Mean length of the 3-D error."""
    rmse_mm: float
    """Root mean square length of the 3-D error."""
    p95_mm: float
    """95th percentile of the length."""
    max_mm: float
    """Greatest length."""


def error_statistics(predicted: AnyArray, true: AnyArray) -> ErrorStatistics:
    """Return the statistics of points; at least one must be finite in both, the rest is ignored.

    Parameters
    ----------
    predicted, true : array_like, shape (n, 3)
        Millimetres.

    Raises
    ------
    InputError, InputTypeError
        One has another shape, or is not made of numbers.
    """
    predicted = float_array(predicted, ("n", 3), "predicted")
    error = predicted - float_array(true, predicted.shape, "true")
    error = error[np.isfinite(error).all(axis=1)]
    if len(error) == 0:
        nan = float("nan")
        return ErrorStatistics(0, (nan, nan, nan), nan, nan, nan, nan)
    length = np.linalg.norm(error, axis=1)
    x, y, z = error.mean(axis=0).tolist()
    return ErrorStatistics(
        n=len(error),
        mean_signed_mm=(x, y, z),
        mae_mm=float(length.mean()),
        rmse_mm=float(np.sqrt((length**2).mean())),
        p95_mm=float(np.percentile(length, 95)),
        max_mm=float(length.max()),
    )


def coverage(error: AnyArray, covariance: AnyArray) -> float:
    """Return the share of errors within their own 95% ellipsoids; NaN if no covariance is stated.

    Parameters
    ----------
    error : array_like, shape (n, 3)
        Millimetres.
    covariance : array_like, shape (n, 3, 3)
        As the method states it, mm squared.

    Raises
    ------
    InputError, InputTypeError
        One has another shape, or is not made of numbers.
    """
    error = float_array(error, ("n", 3), "error")
    covariance = float_array(covariance, (len(error), 3, 3), "covariance")
    stated = positive_definite(covariance) & np.isfinite(error).all(axis=1)
    if not stated.any():
        return float("nan")
    return float(within_ellipsoids(error[stated], covariance[stated], CONFIDENCE).mean())
