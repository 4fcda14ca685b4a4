"""The pose of points in space from the directions in which they are seen, whatever the lens."""

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pose, Vectors3
from labcal.errors import InputError
from labcal.geometry.map_from_rays import map_from_rays
from labcal.geometry.poses import nearest_rotation, pose

_FEWEST = 6


def pose_from_rays(directions: Float64[np.ndarray, "n 3"], p: Vectors3) -> Pose:
    """Return ``T_cam_world`` of points that are seen along directions from one place.

    Parameters
    ----------
    directions : ndarray, shape (n, 3)
        Unit directions from the camera, also to its sides and behind it; at least six.
    p : ndarray, shape (n, 3)
        World points, mm, not all on one plane.

    Returns
    -------
    ndarray, shape (4, 4)
        A start for refinement: it makes an algebraic error small.

    Raises
    ------
    InputError
        Fewer than six points, or they determine no pose.

    Notes
    -----
    Every point demands that ``v x (A p + t)`` vanishes; the least singular vector gives A and t, and the
    nearest rotation to A the pose (the direct linear transform with directions in the place of pixels).
    """
    if len(p) < _FEWEST:
        raise InputError(f"A pose from rays needs at least {_FEWEST} points, but got {len(p)}.")
    found = map_from_rays(directions, p)
    if found.is_open:
        raise InputError("A pose from rays needs points that are not all on one plane.")
    M = found.linear
    R, stretch = nearest_rotation(M[:, :3])
    return pose(R, found.scale * M[:, 3] / stretch.mean() - R @ found.middle)
