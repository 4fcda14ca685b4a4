"""The pose of points in space from the directions in which they are seen, whatever the lens."""

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Points, Pose
from labcal.errors import InputError
from labcal.geometry.poses import pose

_FEWEST = 6


def pose_from_rays(directions: Float64[np.ndarray, "n 3"], p: Points) -> Pose:
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
    middle = p.mean(axis=0)
    scale = np.sqrt(((p - middle) ** 2).sum(axis=1).mean()) or 1.0
    normalised = np.column_stack([(p - middle) / scale, np.ones(len(p))])
    x, y, z = directions.T
    o = np.zeros_like(x)
    cross = np.stack([o, -z, y, z, o, -x, -y, x, o], axis=-1).reshape(-1, 3, 3)
    equations = (cross[:, :, :, None] * normalised[:, None, None, :]).reshape(-1, 12)
    _, singular, rows = np.linalg.svd(np.linalg.qr(equations, mode="r"))
    if singular[-2] <= 1e-9 * singular[0]:
        raise InputError("A pose from rays needs points that are not all on one plane.")
    M = rows[-1].reshape(3, 4)
    M = M * np.sign(np.einsum("ni,ij,nj->", directions, M, normalised))
    U, stretch, Vt = np.linalg.svd(M[:, :3])
    R = U @ np.diag([1.0, 1.0, np.linalg.det(U @ Vt)]) @ Vt
    return pose(R, scale * M[:, 3] / stretch.mean() - R @ middle)
