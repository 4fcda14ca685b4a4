"""The scene of a rehearsal: the target in the recommended poses, and in further ones to measure."""

from labcal.geometry.poses import inverse, rotation_vector
from labcal.guide.rehearsal.laboratory import laboratory
from labcal.guide.rehearsal.planned_rig import T_SCENE_PLAN, PlannedRig
from labcal.guide.rehearsal.rehearsal import Rehearsal
from labcal.scene.model import Scene
from labcal.scene.placement import HeldPoses, PosedView
from labcal.shoot.manifest import Role

_DIGITS = 9


def held_scene(found: Rehearsal) -> Scene:
    """Return the laboratory in which a rehearsal is confirmed; `labcal render` makes pictures of it."""
    planned = PlannedRig.of(found.plan)
    T_scene_first = T_SCENE_PLAN @ inverse(planned.T_first_plan)
    poses = [*((Role.TRAIN, T) for T in found.views), *((Role.TEST, T) for T in found.test_views)]
    views = []
    for number, (role, T_first_target) in enumerate(poses, start=1):
        T = T_scene_first @ T_first_target
        x, y, z = T[:3, 3].round(_DIGITS).tolist()
        rx, ry, rz = rotation_vector(T).round(_DIGITS).tolist()
        views.append(
            PosedView(name=f"pose-{number:02d}", role=role, origin_mm=(x, y, z), rotation_rad=(rx, ry, rz))
        )
    scene = laboratory(found.plan, len(found.views))
    return scene.model_copy(update={"placement": HeldPoses(kind="poses", views=tuple(views))})
