"""The true and nominal poses of the target in each view of a scene."""

from dataclasses import dataclass

import numpy as np

from labcal.arrays import Pose
from labcal.geometry.poses import from_rotation_vector, pose
from labcal.scene.handheld import handheld_poses
from labcal.scene.model import Scene
from labcal.scene.placement import HeldPoses, Stage
from labcal.scene.printed import steps_mm
from labcal.shoot.manifest import Role


@dataclass(frozen=True)
class PlannedView:
    """One planned view."""

    name: str
    role: Role
    T_world_target: Pose
    """True pose of the target, mm."""
    T_world_target_nominal: Pose | None
    """Pose that the stage reports, mm; None for a hand-held target."""


def planned_views(scene: Scene, seed: int) -> tuple[PlannedView, ...]:
    """Return the views of a scene, in order.

    Parameters
    ----------
    scene : Scene
    seed : int
        Seed of the whole run; poses of a hand-held target and random places on the stage are drawn from it.

    Raises
    ------
    InputError
        The cameras see too little of the target for the hand-held views asked for.
    """
    if isinstance(scene.placement, Stage):
        views = []
        for place in scene.placement.places(seed):
            shift = np.array([*(steps_mm(scene.target) * place.shift_pitches), 0.0])
            T_world_target = pose(np.eye(3), np.array(place.origin_mm) + shift)
            views.append(PlannedView(place.name, place.role, T_world_target, T_world_target))
        return tuple(views)
    if isinstance(scene.placement, HeldPoses):
        return tuple(
            PlannedView(
                view.name,
                view.role,
                from_rotation_vector(np.array(view.rotation_rad), np.array(view.origin_mm)),
                None,
            )
            for view in scene.placement.views
        )
    poses = handheld_poses(scene, seed)
    roles = [Role.TRAIN] * scene.placement.train + [Role.TEST] * scene.placement.test
    return tuple(
        PlannedView(f"pose-{number:02d}", role, T_world_target, None)
        for number, (role, T_world_target) in enumerate(zip(roles, poses, strict=True), start=1)
    )
