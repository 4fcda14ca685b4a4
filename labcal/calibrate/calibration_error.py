"""The error that a calibration causes in points where the target was."""

import numpy as np

from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.cameras.derivatives import projection_derivatives
from labcal.cameras.triangulation_derivatives import triangulation_derivatives
from labcal.geometry.poses import transform
from labcal.targets.catalogue import AnyTarget

_MOST_POINTS = 1000
"""Points that stand for all dots of all views."""


def calibration_variance(found: HandheldCalibration, target: AnyTarget) -> float:
    """Return the mean variance of points by the calibration alone, mm squared, all coordinates together.

    Points are the dots of all views, in the frame of the first camera. Of a single camera, which measures no
    points, the sum of the variances of the rays towards them, in px squared. Infinite where the calibration
    states no covariance.
    """
    covariance = found.rig.covariance
    if covariance is None:
        return float("inf")
    places = target.points() if found.freed is None else found.freed.place
    p = np.concatenate([transform(T, places) for T in found.T_world_target])
    p = p[:: -(-len(p) // _MOST_POINTS)]
    cameras = [found.rig.camera(name) for name in found.rig.cameras]
    if len(cameras) == 1:
        by = projection_derivatives(cameras[0], transform(cameras[0].T_cam_world, p)).by_camera
    else:
        alike = np.tile(np.eye(2), (len(p), len(cameras), 1, 1))
        by = triangulation_derivatives(cameras, p, alike)
    variance = np.einsum("nip,pq,niq->n", by, covariance.matrix, by)
    return float(np.nanmean(variance)) if np.isfinite(variance).any() else float("inf")
