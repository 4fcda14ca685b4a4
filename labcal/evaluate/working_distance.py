"""Precision of points at the distance at which a target was held."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from labcal.arrays import Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.expected_errors import expected_errors


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
    found = expected_errors(cameras, None, p, noise_px)
    across, along = found.sideways.noise_mm, found.depth.noise_mm
    return WorkingDistance(
        found.distance_mm,
        found.nearest_mm,
        found.farthest_mm,
        sigma_mm=float(np.sqrt(2.0 * across**2 + along**2)),
        across_mm=across,
        along_mm=along,
    )
