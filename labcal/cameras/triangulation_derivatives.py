"""Derivatives of triangulated points by the parameters of all cameras, in the order of ``rig.json``."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.derivatives import RUN
from labcal.cameras.parameter_derivatives import parameter_derivatives, parameter_slices

_PAIR = 2


def triangulation_derivatives(
    cameras: Sequence[Camera],
    p: Vectors3,
    covariance: Float64[np.ndarray, "n cameras 2 2"],
    places: Sequence[slice] | None = None,
) -> Float64[np.ndarray, "n 3 parameters"]:
    """Return the derivatives of points, where pixels stay and cameras change.

    Parameters
    ----------
    cameras : sequence of Camera
        At least two; the first one is the world.
    p : ndarray, shape (n, 3)
        Triangulated points, mm; NaN where there is none.
    covariance : ndarray, shape (n, cameras, 2, 2)
        Of their pixels, px squared, by which they were triangulated; NaN of cameras that took no part in a
        point, which then does not depend on them.
    places : sequence of slice, optional
        Of each camera's parameters, as of :func:`parameter_slices` (the first camera is the world), or of
        :func:`posed_slices`.

    Returns
    -------
    ndarray, shape (n, 3, parameters)
        Mm per px, per unit of a coefficient, per rad and per mm; NaN for points that are none.

    Notes
    -----
    A triangulated point is where the gradient ``sum J'W r`` of its reprojection errors r vanishes. By the
    implicit function theorem it moves by ``-(sum J'WJ)^-1 sum J'W G`` per change of the cameras, where J and
    G are the derivatives of pixels by the point and by the cameras, W the inverse covariances of pixels;
    second derivatives times residuals are left out, as in Gauss-Newton.
    """
    places = parameter_slices(cameras) if places is None else places
    found = np.full((len(p), 3, places[-1].stop), np.nan)
    taking_part = np.isfinite(covariance).all(axis=(2, 3))
    usable = np.flatnonzero(np.isfinite(p).all(axis=1) & (taking_part.sum(axis=1) >= _PAIR))
    for first in range(0, len(usable), RUN):
        rows = usable[first : first + RUN]
        found[rows] = _of_some(cameras, places, p[rows], covariance[rows])
    return found


def _of_some(
    cameras: Sequence[Camera],
    places: Sequence[slice],
    p: Vectors3,
    covariance: Float64[np.ndarray, "n cameras 2 2"],
) -> Float64[np.ndarray, "n 3 parameters"]:
    """Return the derivatives of points that two cameras or more image."""
    normal = np.zeros((len(p), 3, 3))
    gradient = np.zeros((len(p), 3, places[-1].stop))
    for number, (camera, place) in enumerate(zip(cameras, places, strict=True)):
        at = np.isfinite(covariance[:, number]).all(axis=(1, 2))
        found = parameter_derivatives(camera, p[at])
        weighted = found.by_point.transpose(0, 2, 1) @ np.linalg.inv(covariance[at, number])
        normal[at] += weighted @ found.by_point
        gradient[at, :, place] = weighted @ found.by_parameters[:, :, : place.stop - place.start]
    return np.asarray(-np.linalg.solve(normal, gradient))
