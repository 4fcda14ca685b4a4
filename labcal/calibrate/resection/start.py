"""Initial values of a resection: cameras without distortion, the nearest to the pixels first."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.linalg

from labcal.arrays import Pixels, Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.lens import undistorted_dist
from labcal.errors import InputError
from labcal.geometry.parallel_pose import parallel_camera
from labcal.geometry.pose_from_rays import pose_from_rays
from labcal.geometry.poses import pose
from labcal.geometry.projective_map import projective_map

_HALF_FIELDS_DEG = np.geomspace(8.0, 120.0, 24)
_WIDEST_FLAT_DEG = 70.0
_HELD_DIAGONALS = 10.0
_KEPT, _KEPT_OF_SEVERAL = 2, 6
"""Starts that are worth an adjustment, of one kind of camera and of several together."""


def resection_starts(q: Pixels, p: Vectors3, kinds: Sequence[Camera]) -> list[Camera]:
    """Return cameras to begin with, the most promising first.

    Parameters
    ----------
    q : ndarray, shape (n, 2)
        Pixels.
    p : ndarray, shape (n, 3)
        World points, mm, not all on one plane.
    kinds : sequence of Camera
        Of each the size, lens, prescription and window; other parameters do not matter.

    Raises
    ------
    InputError
        No camera of this kind sees the points anywhere near the pixels.

    Notes
    -----
    Focal lengths are scanned, each with the pose that its rays give, the principal point in the picture's
    middle. A lens that images straight lines nearly straight also begins as the direct linear transform.
    """
    candidates: list[Camera | None] = []
    for kind in kinds:
        if kind.model.parallel:
            candidates.append(parallel_start(q, p, kind))
            continue
        candidates += [_with_pose(camera_with_field(kind, field), q, p) for field in _fields(kind)]
        if kind.model.rectilinear:
            candidates.append(_linear(q, p, kind))
    kept = _KEPT if len(kinds) == 1 else _KEPT_OF_SEVERAL
    residuals = [np.inf if camera is None else _residual(camera, q, p) for camera in candidates]
    order = np.argsort(residuals, kind="stable")[:kept]
    starts = [candidates[i] for i in order if np.isfinite(residuals[i])]
    if not starts:
        raise InputError(
            "resection: no camera sees the dots anywhere near their pixels; check that columns and dots "
            "belong together."
        )
    return [camera for camera in starts if camera is not None]


def depth_held_mm(kind: Camera, scale: float) -> float:
    """Return the depth at which a camera with parallel rays has the middle of what it sees, by agreement.

    No picture tells it. It is ten diagonals of the field, so that all of the scene is in front of the camera.
    """
    return _HELD_DIAGONALS * float(np.hypot(*kind.size)) / scale


def parallel_start(q: Pixels, p: Vectors3, kind: Camera) -> Camera | None:
    """Return the camera with parallel rays of the affine map, without distortion; None where there is none.

    Parameters
    ----------
    q, p : ndarray, shapes (n, 2) and (n, 3)
        Pixels, and world points in mm.
    kind : Camera
        Size and lens, whose rays are parallel; its other parameters do not matter.
    """
    middle = 0.5 * (np.array(kind.size) - 1.0)
    try:
        (fx, fy), T = parallel_camera(q - middle, p, 0.0)
    except InputError:
        return None
    T[2, 3] += depth_held_mm(kind, float(np.sqrt(fx * fy)))
    K = np.array([[fx, 0.0, middle[0]], [0.0, fy, middle[1]], [0.0, 0.0, 1.0]])
    return replace(kind, K=K, dist=undistorted_dist(kind.model), T_cam_world=T)


def _fields(kind: Camera) -> list[float]:
    """Return the angles (rad) from the axis at which the picture's corners are tried."""
    widest = _WIDEST_FLAT_DEG if kind.model.rectilinear else 180.0
    return [float(np.radians(field)) for field in _HALF_FIELDS_DEG if field <= widest]


def camera_with_field(kind: Camera, field: float) -> Camera:
    """Return the camera without distortion whose picture's corners see an angle (rad) from the axis.

    Parameters
    ----------
    kind : Camera
        Size, lens, prescription and window; its other parameters do not matter.
    field : float
        Below a right angle for a rectilinear lens.
    """
    width, height = kind.size
    corner = 0.5 * float(np.hypot(width, height))
    f = corner / kind.model.undistorted_radius(field)
    K = np.array([[f, 0.0, 0.5 * (width - 1)], [0.0, f, 0.5 * (height - 1)], [0.0, 0.0, 1.0]])
    return replace(kind, K=K, dist=undistorted_dist(kind.model), T_cam_world=np.eye(4))


def _with_pose(camera: Camera, q: Pixels, p: Vectors3) -> Camera | None:
    rays = camera.rays(q)
    if rays.ok.mean() < 0.5:  # noqa: PLR2004 -- a picture's corners may lie beyond a lens's field
        return None
    try:
        return replace(camera, T_cam_world=pose_from_rays(rays.direction[rays.ok], p[rays.ok]))
    except InputError:
        return None


def _linear(q: Pixels, p: Vectors3, kind: Camera) -> Camera | None:
    """Return the pinhole of the linear projection, without skew (Hartley and Zisserman, section 6.2.4)."""
    try:
        projection = projective_map("resection", p, q)
    except InputError:
        return None
    K, R = scipy.linalg.rq(projection[:, :3])
    signs = np.sign(np.diagonal(K))
    K, R = K * signs, signs[:, None] * R
    if np.linalg.det(R) < 0:  # pixels alone do not tell a projection matrix from its negative
        return None
    t = np.linalg.solve(K, projection[:, 3])
    K = K / K[2, 2]
    K[0, 1] = K[1, 0] = K[2, 0] = K[2, 1] = 0.0
    if kind.prescription is not None:
        K[0, 0] = K[1, 1] = 0.5 * (K[0, 0] + K[1, 1])
    return replace(kind, K=K, dist=undistorted_dist(kind.model), T_cam_world=pose(R, t))


def _residual(camera: Camera, q: Pixels, p: Vectors3) -> float:
    """Return the root mean square distance, px; infinite where points cannot be imaged."""
    found = camera.project(p)
    if not found.ok.all():
        return float("inf")
    return float(np.sqrt(((found.q - q) ** 2).sum(axis=1).mean()))
