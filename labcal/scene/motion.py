"""Motion of the target during an exposure, and the exposure times of rows."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from pydantic import BaseModel, ConfigDict
from scipy.spatial.transform import Rotation

from labcal.arrays import Pose, Vectors3
from labcal.geometry.poses import from_rotation_vector, pose, transform
from labcal.scene.camera import Vector


class ShutterKind(StrEnum):
    """Shutter: all rows of a picture are exposed together, or one after another."""

    GLOBAL = "global"
    ROLLING = "rolling"
    """Row after row, from the top."""


class Motion(BaseModel):
    """Uniform motion of the target during every exposure; none by default."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    velocity_mm_s: Vector = (0.0, 0.0, 0.0)
    """Velocity of the board's middle in the world."""
    rotation_deg_s: Vector = (0.0, 0.0, 0.0)
    """Turning about the board's middle: the axis in the world, as long as the degrees per second."""


@dataclass(frozen=True)
class Track:
    """The pose of the target over time; at 0 s, the middle of the frame, it is the pose of the view."""

    T_world_target: Pose
    """Pose at 0 s, mm."""
    middle: Vectors3
    """The board's middle at 0 s, world, mm, shape (3,)."""
    velocity: np.ndarray
    """mm/s, world, shape (3,)."""
    rotation: np.ndarray
    """Axis in the world times rad/s, shape (3,)."""

    @property
    def stands_still(self) -> bool:
        """True if the pose is constant."""
        return not (self.velocity.any() or self.rotation.any())

    def at(self, seconds: float) -> Pose:
        """Return ``T_world_target`` (mm) at a time."""
        turn = from_rotation_vector(seconds * self.rotation, self.middle + seconds * self.velocity)
        T_world_target: Pose = turn @ pose(np.eye(3), -self.middle) @ self.T_world_target
        return T_world_target

    def carried(self, p: Vectors3, seconds: np.ndarray) -> Vectors3:
        """Return points of the target in the world, each at its own time.

        Parameters
        ----------
        p : ndarray, shape (..., 3)
            Target frame, mm.
        seconds : ndarray, shape (...)
        """
        at_rest = transform(self.T_world_target, p)
        if self.stands_still:
            return at_rest
        arm = at_rest - self.middle
        turns = Rotation.from_rotvec(seconds.reshape(-1, 1) * self.rotation)
        moved = turns.apply(arm.reshape(-1, 3)).reshape(p.shape)
        return np.asarray(moved + self.middle + seconds[..., None] * self.velocity)


@dataclass(frozen=True)
class ShutterTimes:
    """Exposure times of the rows of a picture, in seconds from the middle of the frame."""

    exposure_s: float
    """Duration of the exposure of each row."""
    readout_s: float
    """From the first row's exposure to the last one's; 0 for a global shutter."""
    rows: int

    @property
    def span_s(self) -> float:
        """Duration from the beginning of the first row to the end of the last one."""
        return self.exposure_s + self.readout_s

    def middles(self, rows: np.ndarray) -> np.ndarray:
        """Return the middle of the exposure of rows, which may be fractional or outside the picture."""
        seconds: np.ndarray = self.readout_s * (rows / max(1, self.rows - 1) - 0.5)
        return seconds
