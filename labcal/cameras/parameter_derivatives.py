"""Pixels with their derivatives by a point in the world, and by a camera's lens and pose."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels, PointJacobians, Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.derivatives import projection_derivatives
from labcal.cameras.optics import INTRINSICS
from labcal.geometry.cross_matrices import cross_matrices
from labcal.geometry.poses import transform

POSE = 6
"""A rotation vector, rad, and a shift, mm, both along the camera's axes; the first camera has none."""


@dataclass(frozen=True)
class ParameterDerivatives:
    """Images of n points in one camera, and their derivatives."""

    q: Pixels
    """(n, 2), px; the lens formula's value even beyond the lens's fold."""
    by_point: PointJacobians
    """(n, 2, 3), by the point in the world, px/mm."""
    by_parameters: Float64[np.ndarray, "n 2 parameters"]
    """(n, 2, parameters), by fx fy cx cy, coefficients, turn and shift, in the order of ``rig.json``."""


def parameter_derivatives(camera: Camera, p: Vectors3) -> ParameterDerivatives:
    """Return the images of points and their derivatives.

    Parameters
    ----------
    camera : Camera
    p : ndarray, shape (n, 3)
        Places in the world, mm.
    """
    p_cam = transform(camera.T_cam_world, p)
    found = projection_derivatives(camera, p_cam)
    # The camera's rotation turns points about its centre: w x (R p) = -[R p] w.
    turned = -found.by_point @ cross_matrices(p_cam - camera.T_cam_world[:3, 3])
    return ParameterDerivatives(
        found.q,
        found.by_point @ camera.T_cam_world[:3, :3],
        np.concatenate([found.by_camera, turned, found.by_point], axis=2),
    )


def parameter_slices(cameras: Sequence[Camera]) -> list[slice]:
    """Return the place of each camera's parameters among those of a rig; the first one's pose is exact."""
    places, first = list[slice](), 0
    for number, camera in enumerate(cameras):
        last = first + INTRINSICS + camera.model.coefficients + (POSE if number else 0)
        places.append(slice(first, last))
        first = last
    return places


def posed_slices(cameras: Sequence[Camera]) -> list[slice]:
    """Return the same where the world is not the first camera's, which then has a pose, too."""
    last = np.cumsum([INTRINSICS + camera.model.coefficients + POSE for camera in cameras]).tolist()
    return [slice(first, end) for first, end in zip([0, *last], last, strict=False)]


def parameter_count(cameras: Sequence[Camera]) -> int:
    """Return the number of parameters: each camera's lens, and the pose of all but the first."""
    return int(parameter_slices(cameras)[-1].stop)
