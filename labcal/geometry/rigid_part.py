"""What is left of motions of points when a rigid motion of all of them together is taken out."""

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Vectors3
from labcal.geometry.cross_matrices import cross_matrices


def without_rigid_part(
    moved: Float64[np.ndarray, "n 3 directions"], p: Vectors3
) -> Float64[np.ndarray, "n 3 directions"]:
    """Return motions of points without their rigid part: change of shape and size alone.

    Parameters
    ----------
    moved : ndarray, shape (n, 3, directions)
        Motions of all points in several directions, for example derivatives by parameters.
    p : ndarray, shape (n, 3)
        The points; at least three, not on a line.

    Notes
    -----
    With M the derivatives of all points by the six parameters of a rigid motion, ``D - M (M'M)^-1 M'D`` takes
    the place of D, as an alignment by least squares does.

    Examples
    --------
    >>> p = np.random.default_rng(0).normal(size=(9, 3))
    >>> shift = np.broadcast_to(np.eye(3), (9, 3, 3))
    >>> bool(np.abs(without_rigid_part(shift, p)).max() < 1e-12)
    True
    """
    n = len(p)
    turn, shift = -cross_matrices(p - p.mean(axis=0)), np.broadcast_to(np.eye(3), (n, 3, 3))
    rigid, _ = np.linalg.qr(np.concatenate([turn, shift], axis=2).reshape(3 * n, 6))
    flat = moved.reshape(3 * n, -1)
    return np.asarray((flat - rigid @ (rigid.T @ flat)).reshape(moved.shape))
