"""The share of a calibration in the covariances of points, by the joint covariance of its cameras."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64

from labcal.arrays import PointCovariances, Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.derivatives import RUN
from labcal.cameras.triangulation_derivatives import triangulation_derivatives


def calibration_share(
    cameras: Sequence[Camera],
    parameters: Float64[np.ndarray, "parameters parameters"],
    p: Vectors3,
    covariance: Float64[np.ndarray, "n cameras 2 2"],
    places: Sequence[slice] | None = None,
) -> PointCovariances:
    """Return the covariances of points by errors of the cameras that triangulated them, mm squared.

    Parameters
    ----------
    cameras : sequence of Camera
        At least two; the first one is the world.
    parameters : ndarray, shape (parameters, parameters)
        Joint covariance of the cameras' parameters, in the order of ``rig.json``.
    p : ndarray, shape (n, 3)
        Mm; NaN where there is none.
    covariance : ndarray, shape (n, cameras, 2, 2)
        Of their pixels, px squared, by which they were triangulated.
    places : sequence of slice, optional
        Of each camera's parameters, where the world is not the first camera's (`posed_slices`).

    Returns
    -------
    ndarray, shape (n, 3, 3)
        NaN for points that are none.
    """
    share = np.empty((len(p), 3, 3))
    for first in range(0, len(p), RUN):
        rows = slice(first, first + RUN)
        by = triangulation_derivatives(cameras, p[rows], covariance[rows], places)
        carried = (by.reshape(-1, by.shape[2]) @ parameters).reshape(by.shape)
        share[rows] = carried @ by.transpose(0, 2, 1)
    return share
