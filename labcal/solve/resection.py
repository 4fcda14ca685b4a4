"""A camera from known points in space: where it is, and what its lens does."""

import numpy as np
import scipy.linalg
from jaxtyping import Float64

from labcal.arrays import Pixels, Points
from labcal.cameras.camera import Camera
from labcal.cameras.lens import LENGTH
from labcal.errors import InputError
from labcal.geometry.poses import inverse, pose
from labcal.solve.adjustment.observations import Observations
from labcal.solve.adjustment.rounds import adjust_in_rounds
from labcal.solve.adjustment.state import Freedom, Lenses, RigState
from labcal.solve.blas_threads import one_blas_thread
from labcal.solve.geometry_checks import refuse_collinear, refuse_few, refuse_one_plane
from labcal.solve.projective_map import projective_map

LENS = "brown-k1k2"
_FEWEST = 12
_MOST_OFF = 0.01
"""RMS residual, as a share of the picture's width, from which on the lens is of another kind."""
_NAME = "resection"


@one_blas_thread()
def resected_camera(q: Pixels, p: Points, size: tuple[int, int]) -> Camera:
    """Return the camera that images points nearest to pixels, with the lens :data:`LENS`.

    Parameters
    ----------
    q : ndarray, shape (n, 2)
        Pixels.
    p : ndarray, shape (n, 3)
        World points, mm, not all on one plane.
    size : (int, int)
        Width and height of the picture, px.

    Raises
    ------
    InputError
        Too few points, all on a plane, or no such camera images them anywhere near the pixels.

    Notes
    -----
    The direct linear transform starts; all points are then one rigid body in the bundle adjustment's only
    view, and the camera stands where that body's pose says.
    """
    refuse_few(_NAME, len(p), _FEWEST)
    refuse_collinear(_NAME, p)
    refuse_one_plane(_NAME, p)
    middle = p.mean(axis=0)
    start = _from_projection(projective_map(_NAME, p - middle, q), size)
    zeros = np.zeros(len(p), dtype=np.int64)
    covariance = np.tile(1e-4 * np.eye(2), (len(p), 1, 1))
    observations = Observations(zeros, zeros, np.arange(len(p)), q, covariance)
    lens = Camera(start.K, LENS, start.dist, np.eye(4), size)
    state = RigState((lens,), start.T_cam_world[None], p - middle)
    if not np.isfinite(state.residuals(observations)).all():
        raise InputError(f"{_NAME}: points lie behind the camera that the linear transform gives.")
    freedom = Freedom(Lenses.FREE, np.zeros((3 * len(p), 0)))
    found = adjust_in_rounds(state, observations, freedom, np.zeros(len(p)), bias_rounds=0)
    rms = float(np.sqrt((found.residual**2).sum(axis=1).mean()))
    if not rms <= _MOST_OFF * size[0]:
        raise InputError(
            f"{_NAME}: no camera with the lens '{LENS}' explains the dots; the best is off by {rms:.1f} px."
        )
    camera, T_cam_middle = found.state.cameras[0], found.state.T_world_target[0]
    T_cam_world = T_cam_middle @ inverse(pose(np.eye(3), middle))
    return Camera(camera.K, LENS, camera.dist, T_cam_world, size)


def _from_projection(projection: Float64[np.ndarray, "3 4"], size: tuple[int, int]) -> Camera:
    """Return the pinhole of a projection matrix, without its skew (Hartley and Zisserman, section 6.2.4)."""
    K, R = scipy.linalg.rq(projection[:, :3])
    signs = np.sign(np.diagonal(K))
    K, R = K * signs, signs[:, None] * R
    if np.linalg.det(R) < 0:  # pixels alone do not tell a projection matrix from its negative
        raise InputError(f"{_NAME}: the dots are a mirror image of what a camera sees; check their order.")
    t = np.linalg.solve(K, projection[:, 3])
    K = K / K[2, 2]
    K[0, 1] = K[1, 0] = K[2, 0] = K[2, 1] = 0.0
    return Camera(K, LENS, np.zeros(LENGTH), pose(R, t), size)
