"""The pose of a plane from the directions in which its points are seen, whatever the lens."""

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pose
from labcal.errors import InputError
from labcal.geometry.map_from_rays import map_from_rays
from labcal.geometry.poses import nearest_rotation, pose

_FEWEST = 4
"""Share of the largest eigenvalue below which the second smallest one is rounding: points on a line."""


def plane_pose(directions: Float64[np.ndarray, "n 3"], plane_mm: Float64[np.ndarray, "n 2"]) -> Pose:
    """Return ``T_cam_plane`` of a plane z = 0 whose points are seen along directions.

    Parameters
    ----------
    directions : ndarray, shape (n, 3)
        Unit directions from the camera, also to its sides and behind it; at least four, no three of the
        points on a line.
    plane_mm : ndarray, shape (n, 2)
        The points' x and y on the plane, mm.

    Returns
    -------
    ndarray, shape (4, 4)
        A start for refinement: it makes an algebraic error small.

    Raises
    ------
    InputError
        Fewer than four points, or all on one line.

    Notes
    -----
    A homography H = [r1 r2 t] takes (x, y, 1) to a vector along the direction; every point demands that
    their cross product vanishes (Zhang 2000, section 2, with directions in the place of pixels).
    """
    if len(plane_mm) < _FEWEST:
        raise InputError(f"The pose of a plane needs at least {_FEWEST} points, but got {len(plane_mm)}.")
    found = map_from_rays(directions, plane_mm)
    if found.is_open:
        raise InputError("The pose of a plane needs points that do not all lie on one line.")
    H = found.linear
    size = 0.5 * (np.linalg.norm(H[:, 0]) + np.linalg.norm(H[:, 1]))
    first, second, third = (H / size).T
    R, _ = nearest_rotation(np.column_stack([first, second, np.cross(first, second)]))
    return pose(R, found.scale * third - R @ np.array([*found.middle, 0.0]))
