"""A simulated hand: it takes the pose that a guided capture asks for, with the errors of a hand."""

from collections.abc import Mapping

import numpy as np

from labcal.arrays import Pixels, Pose, Vectors3
from labcal.cameras.camera import Camera
from labcal.capture.advice import Advice
from labcal.geometry.poses import inverse, pose
from labcal.guide.next_pose.findable import OUTLINE_STEPS, Findable
from labcal.guide.next_pose.first_poses import FIRST_POSES, pose_by_pixels, turned_away
from labcal.guide.next_pose.hand import HandError
from labcal.guide.next_pose.volume import middle_of_eyes
from labcal.rng import generator
from labcal.scene.model import Scene
from labcal.scene.placement import Handheld
from labcal.scene.views import planned_views
from labcal.targets.catalogue import AnyTarget


class SimulatedHand:
    """The hand of somebody who sees the cameras' pictures and follows the advice.

    Parameters
    ----------
    cameras : mapping of str to Camera
        The true ones, in any one frame; the first one is the world of calibrations.
    target : AnyTarget
    start : ndarray, shape (3,)
        Where things will be measured, in the frame of the cameras, mm: the target is held there first.
    error : HandError
    seed : int
    """

    def __init__(
        self, cameras: Mapping[str, Camera], target: AnyTarget, start: Vectors3, error: HandError, seed: int
    ) -> None:
        self._cameras, self._start, self._error = dict(cameras), start, error
        self._findable = Findable.of(target)
        self._random = generator(seed, "simulated hand")
        self._T_first_world = next(iter(self._cameras.values())).T_cam_world

    def pose_for(self, advice: Advice) -> Pose:
        """Return ``T_world_target`` (mm), in the frame of the cameras, of what the hand does."""
        asked = advice.T_world_target
        if asked is None:
            asked = self._by_outline(advice.outlines) if advice.views else self._first()
        taken = self._error.taken(asked, self._findable.middle, self._random)
        return np.asarray(inverse(self._T_first_world) @ taken)

    def _first(self) -> Pose:
        """Return the very first pose, at the start, in the frame of the first camera."""
        first = next(iter(self._cameras.values()))
        eyes = middle_of_eyes(tuple(self._cameras.values()))
        toward = first.T_cam_world[:3, :3] @ (eyes - self._start)
        toward /= np.linalg.norm(toward)
        right = np.array([1.0, 0.0, 0.0]) - toward[0] * toward
        right /= np.linalg.norm(right)
        facing = np.stack([right, np.cross(toward, right), toward], axis=1)
        upright = facing @ np.diag([1.0, -1.0, -1.0])
        R = upright @ turned_away(FIRST_POSES[0]) @ upright.T @ facing
        place = first.T_cam_world[:3, :3] @ self._start + first.T_cam_world[:3, 3]
        return pose(R, place - R @ self._findable.middle)

    def _by_outline(self, outlines: Mapping[str, Pixels]) -> Pose:
        """Return the pose that fills the outline in the first camera that has one, in the first's frame."""
        name = next(iter(outlines))
        camera = self._cameras[name]
        corners = slice(None, None, OUTLINE_STEPS)
        ray = camera.rays(outlines[name][corners])
        direction = ray.direction @ camera.T_cam_world[:3, :3].T
        T_cam_target = pose_by_pixels(
            self._findable.outline()[corners], direction[:, :2] / direction[:, 2:], np.eye(3)
        )
        return np.asarray(self._T_first_world @ inverse(camera.T_cam_world) @ T_cam_target)


def start_of(scene: Scene, seed: int) -> Vectors3:
    """Return the middle of where a scene puts its target, mm: of the hand's box, or of the stage's places."""
    if isinstance(scene.placement, Handheld):
        return np.array(scene.placement.centre_mm)
    middle = Findable.of(scene.target).middle
    poses = [view.T_world_target for view in planned_views(scene, seed)]
    return np.asarray(np.mean([T[:3, :3] @ middle + T[:3, 3] for T in poses], axis=0))
