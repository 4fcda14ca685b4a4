"""True errors of the cameras of a calibration, in units of its covariance."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.cameras.camera import Camera
from labcal.geometry.poses import pose, rotation_vector


@dataclass(frozen=True)
class CameraErrors:
    """Errors of all parameters of cameras, and the covariance that is stated for them.

    Attributes
    ----------
    error : ndarray, shape (n,)
        Camera after camera: fx fy cx cy, px; coefficients; of all but the first one the rotation about its
        axes, rad, and its translation, mm. Estimated minus true.
    covariance : ndarray, shape (n, n)
    """

    error: Float64[np.ndarray, " n"]
    covariance: Float64[np.ndarray, "n n"]

    @property
    def mean_square(self) -> float:
        """The mean square of the errors in units of their covariance, 1 for a true one."""
        return float(self.error @ np.linalg.solve(self.covariance, self.error) / len(self.error))

    @property
    def sigmas(self) -> Float64[np.ndarray, " n"]:
        """The size of each error in units of its own standard deviation."""
        return np.asarray(np.abs(self.error) / np.sqrt(np.diagonal(self.covariance)))


def camera_errors(
    found: Sequence[Camera], true: Sequence[Camera], covariance: Float64[np.ndarray, "n n"]
) -> CameraErrors:
    """Return the errors of the cameras of a rig whose world is the first one.

    Parameters
    ----------
    found, true : sequence of Camera
        With the same lens models.
    covariance : ndarray, shape (n, n)
        Of the parameters of all cameras in their order, as a calibration states it.
    """
    off: list[float] = []
    for number, (one, other) in enumerate(zip(found, true, strict=True)):
        off += [*np.subtract(one.intrinsics, other.intrinsics), *(one.dist - other.dist)]
        if number:
            turn = one.T_cam_world[:3, :3] @ other.T_cam_world[:3, :3].T
            off += [
                *rotation_vector(pose(turn, np.zeros(3))),
                *(one.T_cam_world[:3, 3] - other.T_cam_world[:3, 3]),
            ]
    return CameraErrors(np.array(off), covariance)
