"""Checks of a scene before rendering."""

import numpy as np

from labcal.cameras.blind_pixels import require_rays_everywhere
from labcal.errors import InputError
from labcal.geometry.poses import transform
from labcal.scene.clearance import require_room
from labcal.scene.lighting import brightest_board
from labcal.scene.model import Scene
from labcal.scene.placement import Handheld
from labcal.scene.plan import built_scene, planned_takes
from labcal.scene.print import TruePrint
from labcal.scene.printed import key_indices
from labcal.scene.subframes import subframes
from labcal.scene.take import Take
from labcal.scene.truth import true_dots
from labcal.scene.views import planned_views
from labcal.scene.visibility import what_hides
from labcal.targets.grid import DotGrid


def check_scene(scene: Scene, seed: int, count: int | None = None) -> None:
    """Raise if a scene cannot be rendered, or if its pictures could not be used.

    Parameters
    ----------
    scene : Scene
    seed : int
        Seed of the run; poses of a hand-held target and misplaced dots are drawn from it.
    count : int, optional
        Only the first so many views are taken, and so a mistake is made among these; all where left out.

    Raises
    ------
    InputError
        A lens folds within its picture; a print does not fit on its
        board; a camera, a lamp or the target is under the floor or behind the wall, or a camera or a lamp
        inside something solid; in some view the target is behind a camera, turned away from it, or a ring (a
        dot, where there are no rings) is hidden or not wholly in its picture; no lamp shines on the target;
        the scene's mistake cannot be made; or the target moves too fast.
    """
    cameras = scene.true_cameras()
    for name, camera in cameras.items():
        require_rays_everywhere(name, camera)
    made = TruePrint.of(scene.target, scene.board, seed)
    views = planned_views(scene, seed)
    as_meant = scene.model_copy(update={"mistake": None})
    for view in views:
        require_room(scene, view, cameras)
    for take in planned_takes(as_meant, views, seed).takes:
        _check_place(as_meant, take)
        _check_key(as_meant, made, take)
    if not (brightest_board(scene, views) > 0.0).all():
        raise InputError(f"No lamp of the scene '{scene.name}' shines on the target. Turn one towards it.")
    built = built_scene(scene)
    TruePrint.of(built.target, built.board, seed)
    for take in planned_takes(scene, views[:count], seed).takes:
        _check_place(built, take)  # a mistake may hide a ring, but not the target
        subframes(take, built.target)


def _check_place(scene: Scene, take: Take) -> None:
    """Raise unless the camera sees the front of the target."""
    where = f"In view '{take.view}' of the scene '{scene.name}'"
    name, camera, T_world_target = take.taken_by, take.device, take.track.T_world_target
    points = transform(T_world_target, scene.target.points())
    if (transform(camera.T_cam_world, points)[:, 2] <= 0.0).any():
        raise InputError(f"{where} the target is behind camera '{name}', or beside it. Move one of them.")
    if float(camera.towards(points[0]) @ T_world_target[:3, 2]) <= 0.0:
        raise InputError(f"{where} camera '{name}' sees the back of the target. Move the camera above it.")


def _check_key(scene: Scene, made: TruePrint, take: Take) -> None:
    """Raise unless the camera sees the rings or, of a grid that has none, all dots.

    Boards may be hidden in part: their detectors tell what of them was seen, and whether that numbers it.
    """
    if isinstance(scene.placement, Handheld) and not scene.placement.all_rings:
        return
    if not isinstance(scene.target, DotGrid):
        return
    dots = true_dots(scene, made, take)
    kind = "ring" if scene.target.rings else "dot"
    for col, row in key_indices(scene.target):
        number = row * scene.target.cols + col
        if not dots.visible[number]:
            ring = f"In view '{take.view}' of the scene '{scene.name}' the {kind} at ({col}, {row})"
            name, eye = take.taken_by, take.device.centre
            body = what_hides(scene, made, take.track.T_world_target, eye, number)
            if body is not None:
                raise InputError(f"{ring} is hidden from camera '{name}' by {body}. Move one of them.")
            q = np.round(dots.centre[number], 1)
            raise InputError(
                f"{ring} is not wholly in the picture of camera '{name}': its centre falls at "
                f"({q[0]}, {q[1]}) px. Move the camera back, or shorten its focal_px."
            )
