"""The state of a bundle adjustment: cameras, target poses, dots; and its free parameters."""

from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property

import numpy as np
from jaxtyping import Float64
from scipy.spatial.transform import Rotation

from labcal.calibrate.adjustment.observations import Observations, Run
from labcal.cameras.camera import Camera
from labcal.cameras.optics import INTRINSICS

POSE = 6
"""A rotation vector (rad), applied after the present rotation, and a shift (mm)."""


class Lenses(StrEnum):
    """Treatment of intrinsics and lens coefficients: estimated or fixed."""

    FREE = "free"
    FIXED = "fixed"


@dataclass(frozen=True)
class Freedom:
    """Free parameters other than the poses, which are always free except for the pose of the first camera."""

    lenses: Lenses
    dots: Float64[np.ndarray, "coordinates free"]
    """(3 dots, free), an orthonormal basis of how the dots may move; no columns where they may not."""


@dataclass(frozen=True)
class RigState:
    """Cameras, target poses and dots. The first camera is the world."""

    cameras: tuple[Camera, ...]
    T_world_target: Float64[np.ndarray, "views 4 4"]
    """Pose of the target by view, mm."""
    dots: Float64[np.ndarray, "dots 3"]
    """Centres in the target's frame, mm."""

    def seen_by(
        self, observations: Observations, run: Run
    ) -> tuple[Float64[np.ndarray, "3 n"], Float64[np.ndarray, "3 n"]]:
        """Return positions of the dots relative to the origin of the target, and to the camera.

        Both in mm along the camera's axes.
        """
        T_cam_target = self.cameras[run.camera].T_cam_world @ self.T_world_target[run.views]
        by_row = np.repeat(T_cam_target[:, :3].reshape(-1, 12).T, run.counts, axis=1).reshape(3, 4, -1)
        x, y, z = self.dots.T[:, observations.dot[run.rows]]
        arm = by_row[:, 0] * x + by_row[:, 1] * y + by_row[:, 2] * z
        return arm, arm + by_row[:, 3]

    def residuals(self, observations: Observations) -> Float64[np.ndarray, "n 2"]:
        """Return predicted minus measured pixels; NaN where a dot cannot be imaged."""
        found = np.empty((len(observations), 2))
        for run in observations.runs:
            _, p = self.seen_by(observations, run)
            found[run.rows] = self.cameras[run.camera].project_in_camera(p.T).q - observations.q[run.rows]
        return found


@dataclass(frozen=True)
class Layout:
    """Positions of shared parameters: camera by camera lens, then pose; then the dots."""

    state: RigState
    freedom: Freedom

    @cached_property
    def lens(self) -> tuple[slice, ...]:
        """By camera: fx fy cx cy and coefficients; empty where fixed."""
        widths = self._lens_widths
        return tuple(
            slice(first, first + width) for first, width in zip(self._camera_starts, widths, strict=True)
        )

    @cached_property
    def pose(self) -> tuple[slice, ...]:
        """By camera: rotation vector and shift; empty for the first."""
        return tuple(
            slice(lens.stop, lens.stop + (POSE if number else 0)) for number, lens in enumerate(self.lens)
        )

    def own(self, camera: int) -> slice:
        """Return the positions of all parameters of one camera."""
        return slice(self.lens[camera].start, self.pose[camera].stop)

    @property
    def dots(self) -> slice:
        """The free directions of the dots."""
        first = self.pose[-1].stop
        return slice(first, first + self.freedom.dots.shape[1])

    @property
    def count(self) -> int:
        """Number of shared parameters."""
        return int(self.dots.stop)

    @property
    def _lens_widths(self) -> list[int]:
        if self.freedom.lenses is Lenses.FIXED:
            return [0] * len(self.state.cameras)
        return [INTRINSICS + camera.model.coefficients for camera in self.state.cameras]

    @property
    def _camera_starts(self) -> list[int]:
        widths = [w + (POSE if number else 0) for number, w in enumerate(self._lens_widths)]
        return [0, *np.cumsum(widths)[:-1].tolist()]

    def stepped(
        self, shared: Float64[np.ndarray, " shared"], views: Float64[np.ndarray, "views 6"]
    ) -> RigState:
        """Return the state after a step.

        Raises
        ------
        InputError
            The step leads to no possible camera.
        """
        cameras = []
        for number, camera in enumerate(self.state.cameras):
            T = camera.T_cam_world
            if number:
                T = moved_poses(T[None], shared[self.pose[number]][None])[0]
            cameras.append(_moved_camera(camera, shared[self.lens[number]], T))
        dots = self.state.dots + (self.freedom.dots @ shared[self.dots]).reshape(-1, 3)
        return RigState(tuple(cameras), moved_poses(self.state.T_world_target, views), dots)


def moved_poses(
    T: Float64[np.ndarray, "n 4 4"], step: Float64[np.ndarray, "n 6"]
) -> Float64[np.ndarray, "n 4 4"]:
    """Return poses after turning their axes by a rotation vector and shifting their origin."""
    moved = T.copy()
    R = Rotation.from_rotvec(step[:, :3]).as_matrix() @ T[:, :3, :3]
    # One step of Newton and Schulz, so that rounding does not add up over many steps.
    moved[:, :3, :3] = 1.5 * R - 0.5 * R @ (R.transpose(0, 2, 1) @ R)
    moved[:, :3, 3] += step[:, 3:]
    return moved


def _moved_camera(camera: Camera, step: Float64[np.ndarray, " free"], T_cam_world: np.ndarray) -> Camera:
    if len(step) == 0:
        return replace(camera, T_cam_world=T_cam_world)
    fx, fy, cx, cy = np.array(camera.intrinsics) + step[:INTRINSICS]
    dist = camera.dist.copy()
    dist[: len(step) - INTRINSICS] += step[INTRINSICS:]
    K = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    return replace(camera, K=K, dist=dist, T_cam_world=T_cam_world)
