"""Precision of points at the distance at which a target was held."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from labcal.arrays import Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.triangulation import triangulation_limit

_SEES_DEPTH = 2
"""Cameras from which on there are points in space."""


@dataclass(frozen=True)
class WorkingDistance:
    """Standard deviations of triangulated points by the noise of pixels alone; the cameras are exact.

    Attributes
    ----------
    distance_mm : float
        Median distance of the points from the middle between the cameras.
    nearest_mm, farthest_mm : float
    sigma_mm : float
        RMS length of the 3-D error; NaN of a single camera.
    across_mm, along_mm : float
        RMS standard deviations across the direction of view (of one axis) and along it, in depth; NaN of a
        single camera in depth.
    """

    distance_mm: float
    nearest_mm: float
    farthest_mm: float
    sigma_mm: float
    across_mm: float
    along_mm: float


def usual_distance(cameras: Collection[Camera], p: Vectors3) -> float | None:
    """Return the median distance of points from the middle between cameras, mm; None without cameras."""
    if not cameras:
        return None
    middle = np.mean([camera.centre for camera in cameras], axis=0)
    return float(np.median(np.linalg.norm(p - middle, axis=1)))


def working_distance(cameras: Sequence[Camera], p: Vectors3, noise_px: Sequence[float]) -> WorkingDistance:
    """Return the precision of points at places like these.

    Parameters
    ----------
    cameras : sequence of Camera
    p : ndarray, shape (n, 3)
        Places in the world, mm; those that a camera does not see are left out.
    noise_px : sequence of float
        Standard deviation of pixels along each axis, by camera.
    """
    seen = np.all([camera.in_picture(camera.project(p).q) for camera in cameras], axis=0)
    p = p[seen]
    middle = np.mean([camera.centre for camera in cameras], axis=0)
    distance = np.linalg.norm(p - middle, axis=1)
    if len(p) == 0:
        nan = float("nan")
        return WorkingDistance(nan, nan, nan, nan, nan, nan)
    usual, nearest, farthest = (float(f(distance)) for f in (np.median, np.min, np.max))
    if len(cameras) < _SEES_DEPTH:
        (camera,) = cameras
        scale = float(np.mean([camera.K[0, 0], camera.K[1, 1]]))  # of parallel rays px/mm
        across = noise_px[0] / scale * (1.0 if camera.model.parallel else usual)
        nan = float("nan")
        return WorkingDistance(usual, nearest, farthest, nan, across, nan)
    covariance = np.tile(np.eye(2), (len(p), len(cameras), 1, 1))
    covariance *= np.square(np.maximum(noise_px, 1e-6))[:, None, None]
    bound = triangulation_limit(cameras, p, covariance)
    direction = (p - middle) / distance[:, None]
    along = np.einsum("ni,nij,nj->n", direction, bound, direction)
    total = np.trace(bound, axis1=1, axis2=2)
    return WorkingDistance(
        usual,
        nearest,
        farthest,
        sigma_mm=float(np.sqrt(total.mean())),
        across_mm=float(np.sqrt(0.5 * (total - along).mean())),
        along_mm=float(np.sqrt(along.mean())),
    )
