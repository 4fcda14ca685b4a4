"""Figures of a region from errors and covariances: what is counted, and of which points."""

import numpy as np

from labcal.arrays import Mask, PointCovariances, Vectors3
from labcal.bench.distortion.figures import RegionFigures
from labcal.evaluate.statistics import CONFIDENCE
from labcal.geometry.covariances import positive_definite
from labcal.geometry.ellipsoids import within_ellipsoids


def region_counts(
    measured: str,
    error: Vectors3,
    covariance: PointCovariances,
    extrapolated: Mask,
    oracle_error: Vectors3 | None = None,
) -> RegionFigures:
    """Return the figures of points with a place; coverage is of those with a covariance.

    Parameters
    ----------
    measured : str
        The name of the region.
    error : ndarray, shape (n, 3)
        Mm; NaN where the method gives no place.
    covariance : ndarray, shape (n, 3, 3)
        As stated, mm squared.
    extrapolated : ndarray of bool, shape (n,)
        Points that are flagged as outside the trained volume.
    oracle_error : ndarray, shape (n, 3), optional
        Mm. A point without a place of the oracle counts for neither.
    """
    known = np.isfinite(error).all(axis=1)
    if oracle_error is not None:
        known &= np.isfinite(oracle_error).all(axis=1)
    states = positive_definite(covariance) & known
    return RegionFigures(
        measured=measured,
        n=len(error),
        predicted=int(known.sum()),
        rmse_mm=_rms(error[known]),
        oracle_mm=float("nan") if oracle_error is None else _rms(oracle_error[known]),
        stated=int(states.sum()),
        covered=int(within_ellipsoids(error[states], covariance[states], CONFIDENCE).sum()),
        extrapolated=int((extrapolated & known).sum()),
    )


def _rms(error: Vectors3) -> float:
    """Return the root mean square length of 3-D errors; NaN of none."""
    return float(np.sqrt((error**2).sum(axis=1).mean())) if len(error) else float("nan")
