"""The pose of a plane from the directions in which its points are seen, whatever the lens."""

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pose
from labcal.errors import InputError
from labcal.geometry.poses import pose

_FEWEST = 4
_OPEN = 1e-14
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
    middle = plane_mm.mean(axis=0)
    scale = np.sqrt(((plane_mm - middle) ** 2).sum(axis=1).mean()) or 1.0
    on_plane = np.column_stack([(plane_mm - middle) / scale, np.ones(len(plane_mm))])
    # The normal matrix of all cross products: with a unit vector v, [v]x' [v]x is 1 - v v'.
    along = (directions[:, :, None] * on_plane[:, None, :]).reshape(-1, 9)
    normal = -along.T @ along
    for axis in range(3):
        block = slice(3 * axis, 3 * axis + 3)
        normal[block, block] += on_plane.T @ on_plane
    square, axes = np.linalg.eigh(normal)
    if square[1] <= _OPEN * square[-1]:
        raise InputError("The pose of a plane needs points that do not all lie on one line.")
    H = axes[:, 0].reshape(3, 3)
    H = H * np.sign((directions * (on_plane @ H.T)).sum())
    size = 0.5 * (np.linalg.norm(H[:, 0]) + np.linalg.norm(H[:, 1]))
    first, second, third = (H / size).T
    U, _, Vt = np.linalg.svd(np.column_stack([first, second, np.cross(first, second)]))
    R = U @ np.diag([1.0, 1.0, np.linalg.det(U @ Vt)]) @ Vt
    return pose(R, scale * third - R @ np.array([*middle, 0.0]))
