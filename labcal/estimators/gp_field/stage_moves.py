"""Errors of a stage's readings as random effects on pixels: each view of a target is off by one motion."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import radians

import numpy as np
import scipy.linalg
from jaxtyping import Float64, Int64

from labcal.arrays import AnyArray, Pose, Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.derivatives import imaged
from labcal.geometry.cross_matrices import cross_matrices

_POSE = 6


@dataclass(frozen=True)
class StageMoves:
    """Motions of training points by errors of a stage, of one standard deviation.

    Attributes
    ----------
    view : int64 array, (n,)
        Number of the view of each point, from 0.
    by_pose : float64 array, (n, 3, 6)
        Motion of the point by the rotation about the target's origin and by its shift, mm.
    """

    view: Int64[np.ndarray, " n"]
    by_pose: Float64[np.ndarray, "n 3 6"]

    @classmethod
    def of(
        cls,
        view: AnyArray,
        p: Vectors3,
        T_world_target: Mapping[str, Pose],
        sigma_mm: float,
        sigma_deg: float,
    ) -> "StageMoves":
        """Return those of training points.

        Parameters
        ----------
        view : ndarray of str, shape (n,)
        p : ndarray, shape (n, 3)
            World points at the stage's readings, mm.
        T_world_target : mapping of str to ndarray of shape (4, 4)
            The stage's readings by view, mm.
        sigma_mm, sigma_deg : float
            Standard deviations of a reading along and about each axis.
        """
        views, number = np.unique(view, return_inverse=True)
        origins = np.array([T_world_target[name][:3, 3] for name in views.tolist()])
        turned = -cross_matrices(p - origins[number])
        by_pose = np.concatenate([turned, np.broadcast_to(np.eye(3), turned.shape)], axis=2)
        return cls(number, by_pose * np.repeat([radians(sigma_deg), sigma_mm], 3))

    def pixels(self, camera: Camera, p: Vectors3) -> Float64[np.ndarray, "n 2 effects"]:
        """Return what they do to the images of the points, px: six columns for each view."""
        each = imaged(camera, p).by_point @ self.by_pose
        found = np.zeros((len(p), int(self.view.max()) + 1, 2, _POSE))
        found[np.arange(len(p)), self.view] = each
        return np.ascontiguousarray(found.transpose(0, 2, 1, 3).reshape(len(p), 2, -1))


def likeliest_moves(
    root: Float64[np.ndarray, "n n"],
    residual: Float64[np.ndarray, "n 2"],
    by_camera: Float64[np.ndarray, "n 2 free"],
    by_stage: Float64[np.ndarray, "n 2 effects"],
) -> Float64[np.ndarray, "n 2"]:
    """Return what of residuals the likeliest errors of the stage explain, px.

    Parameters
    ----------
    root : ndarray, shape (n, n)
        Lower Cholesky factor of the covariance of field and noise, the same for both coordinates, px.
    residual : ndarray, shape (n, 2)
        Measured minus predicted by the camera, px.
    by_camera : ndarray, shape (n, 2, free)
        Derivatives of the prediction.
    by_stage : ndarray, shape (n, 2, effects)
        As :meth:`StageMoves.pixels` returns it.

    Notes
    -----
    Camera and errors of the stage are found together, the latter with unit variances (Henderson 1975).
    """
    n, effects = len(root), by_stage.shape[2]
    both = np.concatenate([residual[:, :, None], by_camera, by_stage], axis=2).reshape(n, -1)
    white = scipy.linalg.solve_triangular(root, both, lower=True, check_finite=False).reshape(2 * n, -1)
    prior = np.zeros((effects, white.shape[1]))
    prior[:, -effects:] = np.eye(effects)
    rows = np.concatenate([white, prior])
    scale = np.linalg.norm(rows[:, 1:], axis=0)
    scale[scale == 0.0] = 1.0
    found = np.linalg.lstsq(rows[:, 1:] / scale, rows[:, 0], rcond=None)[0] / scale
    return np.asarray(by_stage @ found[-effects:])
