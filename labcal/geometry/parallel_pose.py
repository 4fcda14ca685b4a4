"""Poses from parallel rays (scaled orthography): depth is not to be seen, and a plane has two poses.

Tilted towards the camera on one side or on the other, a plane looks the same in parallel projection (the
reversal of Necker 1832): the picture tells the tilt's size and axis, but not its sign.
"""

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels, Pose, Vectors3
from labcal.errors import InputError
from labcal.geometry.poses import pose

_MIRROR = np.diag([1.0, 1.0, -1.0])
_OPEN = 1e-9
"""Share of the largest singular value below which points lie on a line or a plane."""


def affine_map(seen: Pixels, points: Float64[np.ndarray, "n d"]) -> Float64[np.ndarray, "2 d_plus_1"]:
    """Return the affine map A, b nearest to ``seen = A points + b`` in the sense of least squares.

    Parameters
    ----------
    seen : ndarray, shape (n, 2)
        Pixels, or mm across the rays.
    points : ndarray, shape (n, d)
        Millimetres; on a plane d is 2, in space 3.

    Raises
    ------
    InputError
        The points do not span the plane, or space.
    """
    count, dimensions = points.shape
    middle = points.mean(axis=0) if count else np.zeros(dimensions)
    spread = np.linalg.svd(points - middle, compute_uv=False) if count > dimensions else np.zeros(1)
    if spread[-1] <= _OPEN * spread[0]:
        raise InputError(
            f"An affine map needs more than {dimensions} points that span {dimensions} dimensions."
        )
    found, *_ = np.linalg.lstsq(np.column_stack([points - middle, np.ones(count)]), seen, rcond=None)
    A = found[:-1].T
    return np.column_stack([A, found[-1] - A @ middle])


def plane_scale(A: Float64[np.ndarray, "2 2"]) -> float:
    """Return the scale of a parallel projection from the map of a plane, tilted in any way, in its units.

    A tilt shortens the plane along one direction alone, so that the scale is the greatest singular value.
    """
    return float(np.linalg.norm(A, ord=2))


def parallel_plane_pose(across: Pixels, plane_mm: Pixels, depth_mm: float) -> Pose:
    """Return one of the two poses ``T_cam_plane`` of a plane z = 0 that parallel rays see.

    Parameters
    ----------
    across : ndarray, shape (n, 2)
        Where its points lie across the rays in the camera's frame, mm.
    plane_mm : ndarray, shape (n, 2)
        The points' x and y on the plane, mm; not all on one line.
    depth_mm : float
        The plane's origin is put there.

    Returns
    -------
    ndarray, shape (4, 4)
        The other one is its :func:`mirrored`.

    Raises
    ------
    InputError
        Fewer than three points, or all on one line.
    """
    affine = affine_map(across, plane_mm)
    U, stretch, Vt = np.linalg.svd(affine[:, :2])
    shortened = min(1.0, stretch[1] / stretch[0])
    flat = U @ np.diag([1.0, shortened]) @ Vt
    tilt = np.sqrt(1.0 - shortened**2) * Vt[1]
    first, second = (np.array([*flat[:, i], tilt[i]]) for i in range(2))
    R = np.column_stack([first, second, np.cross(first, second)])
    return pose(R, np.array([*affine[:, 2], depth_mm]))


def mirrored(T_cam_plane: Pose) -> Pose:
    """Return the pose of a plane that looks the same through parallel rays: mirrored in depth."""
    return pose(_MIRROR @ T_cam_plane[:3, :3] @ _MIRROR, T_cam_plane[:3, 3])


def parallel_camera(q: Pixels, p: Vectors3, depth_mm: float) -> tuple[Float64[np.ndarray, "2"], Pose]:
    """Return the two scales (px/mm) and ``T_cam_world`` of the parallel camera nearest to pixels.

    Parameters
    ----------
    q : ndarray, shape (n, 2)
        Pixels from the principal point.
    p : ndarray, shape (n, 3)
        World points, mm, not all on one plane.
    depth_mm : float
        The middle of the points is put there.

    Raises
    ------
    InputError
        Fewer than four points, or all on one plane.
    """
    affine = affine_map(q, p)
    scale = np.linalg.norm(affine[:, :3], axis=1)
    x, y = affine[:, :3] / scale[:, None]
    U, _, Vt = np.linalg.svd(np.stack([x, y, np.cross(x, y)]))
    R = U @ Vt
    aside = affine[:, 3] / scale
    return scale, pose(R, np.array([*aside, depth_mm - R[2] @ p.mean(axis=0)]))
