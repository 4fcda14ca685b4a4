"""Clearance of cameras, lamps and target: none under the floor, behind the wall or inside a solid."""

import numpy as np

from labcal.arrays import Vectors3
from labcal.cameras.camera import Camera
from labcal.errors import InputError
from labcal.geometry.poses import transform
from labcal.scene.furniture import blocks, obstacles
from labcal.scene.lamps import Ambient
from labcal.scene.model import Scene
from labcal.scene.surface import Surface
from labcal.scene.views import PlannedView

CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


def require_room(scene: Scene, view: PlannedView, cameras: dict[str, Camera]) -> None:
    """Raise unless cameras, lamps and target of a view are in the room and in no solid body.

    Raises
    ------
    InputError
        One of them is under the floor or behind the wall, or a camera or a lamp is inside the table, the
        target's plate or support, or an occluder.
    """
    places = {f"Camera '{name}'": (camera.centre, "its eye_mm") for name, camera in cameras.items()}
    for number, lamp in enumerate(scene.lamps):
        if not isinstance(lamp, Ambient):
            places[f"lamps.{number}"] = (np.array(lamp.centre_mm), "its centre_mm")
    bodies = (*blocks(scene, view.T_world_target), *obstacles(scene, view.T_world_target))
    for name, (p, key) in places.items():
        what = f"{name} at ({p[0]:g}, {p[1]:g}, {p[2]:g}) mm"
        _require_in_room(scene, p[None], what, f"Move {key}.")
        for body in bodies:
            if body.holds(p).any():
                raise InputError(
                    f"{what} is inside {body.name} in view '{view.name}' of the scene '{scene.name}'. "
                    f"Move {key}."
                )
    surface = Surface.of_board(scene.target, scene.board)
    corners = transform(view.T_world_target, surface.points(surface.middle + surface.half * CORNERS))
    target = f"A corner of the target in view '{view.name}' of the scene '{scene.name}'"
    _require_in_room(scene, corners, target, "Move the target, or room.floor_z_mm or room.wall_y_mm.")


def _require_in_room(scene: Scene, p: Vectors3, what: str, mend: str) -> None:
    """Raise if any of the points (n, 3) is under the floor or behind the wall."""
    if (p[:, 2] <= scene.room.floor_z_mm).any() or (p[:, 1] >= scene.room.wall_y_mm).any():
        raise InputError(f"{what} is under the floor or behind the wall. {mend}")
