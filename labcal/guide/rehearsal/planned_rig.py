"""A plan in numbers: cameras in the frame of the first one, points of the working volume, planned views."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask, Matrix3, Pose, Vectors3
from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.state import RigState
from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import dot_images
from labcal.cameras.rig import Rig
from labcal.geometry.poses import inverse, pose, transform
from labcal.guide.rehearsal.dot_noise import DotNoise, minor_semi_axes
from labcal.guide.rehearsal.laboratory import laboratory
from labcal.guide.rehearsal.rig_plan import RigPlan
from labcal.scene.handheld import handheld_poses

CELLS = (9, 7, 5)
"""Points of the working volume across, upright and in depth."""
T_SCENE_PLAN = pose(np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]), np.zeros(3))
"""From the plan's frame (x right, y down, z forward) to the laboratory's (Z up)."""


@dataclass(frozen=True)
class PlannedRig:
    """Cameras of a plan as a calibration will state them.

    Attributes
    ----------
    plan : RigPlan
    rig : Rig
        The true cameras; the first one is the world.
    T_first_plan : float64 array, (4, 4)
        From the plan's frame to the world, mm.
    """

    plan: RigPlan
    rig: Rig
    T_first_plan: Pose

    @classmethod
    def of(cls, plan: RigPlan) -> "PlannedRig":
        """Return the rig of a plan.

        Raises
        ------
        InputError
            A camera is impossible.
        """
        in_scene = laboratory(plan, plan.shoot.views).true_cameras()
        T_first_scene = next(iter(in_scene.values())).T_cam_world
        cameras = {
            name: Camera(
                camera.K, camera.lens, camera.dist, camera.T_cam_world @ inverse(T_first_scene), camera.size
            )
            for name, camera in in_scene.items()
        }
        return cls(plan, Rig.of(cameras), T_first_scene @ T_SCENE_PLAN)

    @cached_property
    def cameras(self) -> tuple[Camera, ...]:
        """The cameras in order."""
        return tuple(self.rig.camera(name) for name in self.rig.cameras)

    @cached_property
    def grid(self) -> Vectors3:
        """Points over the working volume in the plan's frame, mm, (n, 3); x runs fastest, z slowest."""
        volume = self.plan.volume
        x, y = (
            middle + half * np.linspace(-0.5, 0.5, count)
            for middle, half, count in zip(
                volume.centre_mm, (volume.width_mm, volume.height_mm), CELLS[:2], strict=True
            )
        )
        z = np.linspace(volume.near_mm, volume.far_mm, CELLS[2])
        depth, up, across = np.meshgrid(z, y, x, indexing="ij")
        return np.stack([across.ravel(), up.ravel(), depth.ravel()], axis=-1)

    @property
    def R_plan_first(self) -> Matrix3:
        """Rotation from the world to the plan's frame."""
        return self.T_first_plan[:3, :3].T

    def seen(self, grid: Vectors3) -> Mask:
        """Return a mask of the points of the plan's frame that all cameras see."""
        p = transform(self.T_first_plan, grid)
        return np.asarray(np.all([camera.in_picture(camera.project(p).q) for camera in self.cameras], axis=0))

    def views(self, count: int, seed: int) -> list[Pose]:
        """Return the recommended poses of the target, ``T_first_target``, mm.

        Of random ones those are taken that add most to what is covered, of the pictures and of the
        directions of tilts (:func:`~labcal.scene.handheld.handheld_poses`).

        Raises
        ------
        InputError
            Too few poses show enough of the target to all cameras.
        """
        T_first_scene = self.T_first_plan @ inverse(T_SCENE_PLAN)
        return [T_first_scene @ T for T in handheld_poses(laboratory(self.plan, count), seed)]

    def state(self, views: list[Pose]) -> RigState:
        """Return the true state of the adjustment that the views will lead to."""
        return RigState(self.cameras, np.array(views), self.plan.target.points())

    def observations(self, views: list[Pose], noise: DotNoise) -> Observations:
        """Return the dots that are wholly in the planned pictures, with the covariances to expect."""
        target = self.plan.target
        radii = 0.5 * target.outer_diameters_mm()
        parts: list[tuple[np.ndarray, ...]] = []
        for number, camera in enumerate(self.cameras):
            for view, T in enumerate(views):
                images = dot_images(camera, T, target.points(), radii)
                dot = np.flatnonzero(images.ok & camera.in_picture(images.outline).all(axis=-1))
                size = minor_semi_axes(images.outline[dot])
                of = np.full(len(dot), number, dtype=np.int64), np.full(len(dot), view, dtype=np.int64)
                parts.append((*of, dot, images.centre[dot], noise.covariances(size)))
        camera_of, view_of, dot_of, q, covariance = (
            np.concatenate(column) for column in zip(*parts, strict=True)
        )
        return Observations(camera_of, view_of, dot_of, q, covariance)


def directions(rig: PlannedRig, grid: Vectors3) -> Float64[np.ndarray, "n 3"]:
    """Return the direction of depth at points of the plan's frame: away from the middle of all cameras."""
    eyes = np.array([transform(inverse(rig.T_first_plan), camera.centre) for camera in rig.cameras])
    away = grid - eyes.mean(axis=0)
    return np.asarray(away / np.linalg.norm(away, axis=1, keepdims=True))
