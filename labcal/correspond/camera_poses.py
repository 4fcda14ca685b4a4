"""Poses of boards in the pictures of one camera, by a quick calibration of it alone."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels, Pose
from labcal.detect.dots import PictureDots
from labcal.geometry.poses import from_rotation_vector, rotation_vector
from labcal.targets.target import Target

_FEWEST_PICTURES = 3
_FEWEST_DOTS = 9
_MOST_PICTURES = 40
"""They determine a lens; poses of further ones are resected."""


@dataclass(frozen=True)
class CameraPoses:
    """A camera's lens (pinhole with two radial coefficients, OpenCV's order) and poses of boards by picture.

    Attributes
    ----------
    K : ndarray, shape (3, 3)
        px.
    dist : ndarray, shape (5,)
    T_camera_board : mapping of int to ndarray, shape (4, 4)
        By the picture's index, mm.
    """

    K: Float64[np.ndarray, "3 3"]
    dist: Float64[np.ndarray, "5"]
    T_camera_board: Mapping[int, Pose]

    def project(self, places: Float64[np.ndarray, "n 3"], T_camera_board: Pose) -> Pixels:
        """Return the pixels of places on a board, mm."""
        import cv2  # noqa: PLC0415 -- a large library

        turn, shift = rotation_vector(T_camera_board), T_camera_board[:3, 3]
        q, _ = cv2.projectPoints(places, turn, shift, self.K, self.dist)
        return np.asarray(q[:, 0], dtype=np.float64)


def camera_poses(pictures: Mapping[int, PictureDots], target: Target) -> CameraPoses | None:
    """Calibrate one camera by its pictures of a board, whole ones and parts.

    A part's numbering does not matter for it: a shift on the board is a motion of the board.

    Parameters
    ----------
    pictures : mapping of int to PictureDots
        All of one camera.
    target : Target

    Returns
    -------
    CameraPoses or None
        None where fewer than three pictures show dots enough, or OpenCV finds no lens for them.
    """
    import cv2  # noqa: PLC0415 -- a large library

    shown = {k: dots if dots.indexed else dots.part for k, dots in pictures.items()}
    usable = {k: dots for k, dots in shown.items() if dots is not None and dots.ok.sum() >= _FEWEST_DOTS}
    if len(usable) < _FEWEST_PICTURES or len({dots.size for dots in usable.values()}) != 1:
        return None
    places = {k: target.points(dots.index[dots.ok]).astype(np.float32) for k, dots in usable.items()}
    seen = {k: dots.position[dots.ok].astype(np.float32) for k, dots in usable.items()}
    chosen = list(usable)[:: -(-len(usable) // _MOST_PICTURES)]
    size = next(iter(usable.values())).size
    flags = (
        cv2.CALIB_FIX_ASPECT_RATIO
        | cv2.CALIB_USE_INTRINSIC_GUESS
        | cv2.CALIB_FIX_PRINCIPAL_POINT
        | cv2.CALIB_ZERO_TANGENT_DIST
        | cv2.CALIB_FIX_K3
    )
    focal = float(max(size))
    K = np.array([[focal, 0, (size[0] - 1) / 2], [0, focal, (size[1] - 1) / 2], [0, 0, 1.0]])
    try:
        _, K, dist, _, _ = cv2.calibrateCamera(
            [places[k] for k in chosen], [seen[k] for k in chosen], size, K, np.zeros(5), flags=flags
        )
        found = {}
        for k in usable:
            done, turn, shift = cv2.solvePnP(places[k], seen[k], K, dist)
            if done:
                found[k] = from_rotation_vector(np.ravel(turn), np.ravel(shift))
    except cv2.error:
        return None
    if not (np.isfinite(K).all() and np.isfinite(dist).all()):
        return None
    return CameraPoses(np.asarray(K, float), np.asarray(dist, float).ravel()[:5], found)
