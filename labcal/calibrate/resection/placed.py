"""A camera at its place among points, as a state that steps and has derivatives."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask, Pixels, PointJacobians, Vectors3
from labcal.calibrate.adjustment.state import POSE, moved_poses
from labcal.cameras.camera import Camera
from labcal.cameras.free_parameters import FreeParameters
from labcal.geometry.poses import inverse, pose


@dataclass(frozen=True)
class SeenPoints:
    """Images of n world points, and how they change."""

    q: Pixels
    ok: Mask
    by_point: PointJacobians
    """(n, 2, 3), by the point in the world, px/mm."""
    by_camera: Float64[np.ndarray, "n 2 free"]
    """By the camera's pose (turn, rad, and shift, mm) and free parameters."""


@dataclass(frozen=True)
class PlacedCamera:
    """A camera, and the middle about which its pose turns, so that turns and shifts hardly trade.

    Attributes
    ----------
    camera : Camera
    middle : float64 array, (3,)
        In the world, mm.
    """

    camera: Camera
    middle: Float64[np.ndarray, "3"]

    @property
    def free_parameters(self) -> FreeParameters:
        """The camera's free parameters."""
        return FreeParameters(self.camera)

    @property
    def count(self) -> int:
        """Pose and free parameters."""
        return POSE + self.free_parameters.count

    def seen(self, p: Vectors3) -> SeenPoints:
        """Return the images of world points, mm, with all derivatives."""
        T = self.camera.T_cam_world
        R = T[:3, :3]
        p_cam = p @ R.T + T[:3, 3]
        found = self.free_parameters.imaged(p_cam)
        arm = (p - self.middle) @ R.T
        by_turn = np.cross(arm[:, None, :], found.by_point)
        by_camera = np.concatenate([by_turn, found.by_point, found.by_camera], axis=2)
        return SeenPoints(found.q, found.ok, found.by_point @ R, by_camera)

    def moved(self, step: Float64[np.ndarray, " free"]) -> "PlacedCamera":
        """Return it after a step of pose and free parameters.

        Raises
        ------
        InputError, ValueError
            There is no such camera.
        """
        to_middle = pose(np.eye(3), self.middle)
        T_cam_middle = moved_poses((self.camera.T_cam_world @ to_middle)[None], step[None, :POSE])[0]
        camera = self.free_parameters.moved(step[POSE:])
        return PlacedCamera(replace(camera, T_cam_world=T_cam_middle @ inverse(to_middle)), self.middle)
