"""What is in a scene, as Mitsuba takes it: room, furniture, print, occluders and lamps."""

from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np

from labcal.arrays import Pose
from labcal.geometry.poses import pose
from labcal.render.facets import Facets, box_facets, cylinder_facets, ring_facets, sheet_facets
from labcal.render.paint import Paint
from labcal.render.variant import Jit
from labcal.scene.furniture import blocks, obstacles
from labcal.scene.lamps import Lamp, Panel, Ring, Spot
from labcal.scene.lighting import BLACK, lamp_pose
from labcal.scene.model import Scene
from labcal.scene.quantities import Colour
from labcal.scene.solids import Block, Solid
from labcal.scene.surface import Surface

FAR_MM = 12000.0
"""How far floor and wall reach."""
COAT_INDEX = 1.5
"""Refractive index of a glossy board's clear coat."""
DARKER = 0.8
"""Reflectance of every other tile of the floor."""
UNDER, OVER = "-z", "+z"


@dataclass(frozen=True)
class Placed:
    """A body that stands somewhere in a view."""

    facets: Facets
    T_world_body: Pose
    reflectance: Colour


def bodies(scene: Scene, T_world_target: Pose) -> dict[str, Placed]:
    """Return furniture and occluders by their names in Mitsuba's scene, with the target at a pose.

    What no camera can see is left out, since each triangle costs time on every ray: the table's underside,
    the plate's back, and its front under a flat print. The triangles' number is the same at all poses.
    """
    table, plate, support = blocks(scene, T_world_target)
    from_above = all(camera.eye_mm[2] > scene.room.table_z_mm for camera in scene.cameras.values())
    covered = support.size_mm[0] <= plate.size_mm[0] and support.size_mm[1] <= plate.size_mm[1]
    flat = scene.board.bend.is_flat
    placed = {
        "table": _box(table, UNDER if from_above else ""),
        "plate": _box(plate, UNDER, OVER if flat else ""),
        "support": _box(support, UNDER, OVER if covered else ""),
    }
    for number, solid in enumerate(obstacles(scene, T_world_target)):
        placed[f"occluder-{number}"] = _whole(solid)
    return placed


def _box(block: Block, *left_out: str) -> Placed:
    """Return a block without some of its faces."""
    return Placed(box_facets(block.size_mm, frozenset(left_out)), block.T_world_block, block.reflectance)


def _whole(solid: Solid) -> Placed:
    """Return a solid with all its faces."""
    if isinstance(solid, Block):
        return _box(solid)
    facets = cylinder_facets(solid.length_mm, solid.diameter_mm)
    return Placed(facets, solid.T_world_cylinder, solid.reflectance)


def print_pose(scene: Scene, T_world_target: Pose) -> np.ndarray:
    """Return the matrix (4, 4) that takes Mitsuba's rectangle (-1 to 1) to a flat board."""
    surface = Surface.of(scene.target, scene.board.bend)
    middle = pose(np.eye(3), np.array([*surface.middle, 0.0]))
    matrix: np.ndarray = T_world_target @ middle @ np.diag([*surface.half, 1.0, 1.0])
    return matrix


def contents(mi: ModuleType, scene: Scene, paint: Paint, dots: Jit) -> dict[str, Any]:
    """Return Mitsuba's dictionary of a scene, with the target at the world's origin.

    Parameters
    ----------
    mi : module
    scene : Scene
    paint : Paint
    dots : mitsuba.Texture
        The print.
    """
    found: dict[str, Any] = {"type": "scene", "print": _print(mi, scene, dots)}
    found |= _room(mi, scene, paint)
    for name, body in bodies(scene, np.eye(4)).items():
        found[name] = body.facets.mesh(mi, name, body.T_world_body, {"bsdf": paint.matt(body.reflectance)})
    for number, lamp in enumerate(scene.lamps):
        found |= _lamp(mi, f"lamp-{number}", lamp, paint)
    return found


def _print(mi: ModuleType, scene: Scene, dots: Jit) -> Any:  # noqa: ANN401 -- Mitsuba's
    """Return the board's front: Mitsuba's rectangle where it is flat, else a fine mesh."""
    board = scene.board
    paper: dict[str, Any] = {"type": "diffuse", "reflectance": dots}
    if board.gloss_roughness is not None:
        paper = {
            "type": "roughplastic",
            "distribution": "ggx",
            "alpha": board.gloss_roughness,
            "int_ior": COAT_INDEX,
            "diffuse_reflectance": dots,
        }
    if board.bend.is_flat:
        return _rectangle(mi, print_pose(scene, np.eye(4)), {"bsdf": paper})
    return sheet_facets(Surface.of(scene.target, board.bend)).mesh(mi, "print", np.eye(4), {"bsdf": paper})


def _room(mi: ModuleType, scene: Scene, paint: Paint) -> dict[str, Any]:
    """Return floor and wall."""
    room = scene.room
    tiles = {
        "type": "checkerboard",
        "color0": paint.spectrum(room.floor),
        "color1": paint.spectrum(room.floor, DARKER),
        "to_uv": mi.ScalarTransform4f().scale(FAR_MM / room.tile_mm),
    }
    surfaces = {"floor": {"type": "diffuse", "reflectance": tiles}, "wall": paint.matt(room.wall)}
    return {
        name: _rectangle(mi, place, {"bsdf": surfaces[name]}) for name, place in _room_places(scene).items()
    }


def _room_places(scene: Scene) -> dict[str, np.ndarray]:
    """Return the maps of Mitsuba's rectangle (-1 to 1) to floor and wall."""
    room, far = scene.room, np.diag([FAR_MM, FAR_MM, 1.0, 1.0])
    upright = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    return {
        "floor": pose(np.eye(3), np.array([0.0, 0.0, room.floor_z_mm])) @ far,
        "wall": pose(upright, np.array([0.0, room.wall_y_mm, 0.0])) @ far,
    }


def _panel_place(lamp: Panel) -> np.ndarray:
    """Return the map of Mitsuba's rectangle (-1 to 1) to a panel lamp."""
    width, height = lamp.size_mm
    place: np.ndarray = lamp_pose(lamp) @ np.diag([0.5 * width, 0.5 * height, 1.0, 1.0])
    return place


def _rectangle(mi: ModuleType, place: np.ndarray, inside: dict[str, Any]) -> dict[str, Any]:
    return {"type": "rectangle", "to_world": mi.ScalarTransform4f(place)} | inside


@dataclass(frozen=True)
class FlatPlaces:
    """All flat rectangles of a scene in a view."""

    names: tuple[str, ...]
    """Of the shape in Mitsuba's scene that each belongs to."""
    places: tuple[np.ndarray, ...]
    """(4, 4) each, the map of the square from -1 to 1 into the world, mm."""


def flat_places(scene: Scene, T_world_target: Pose) -> FlatPlaces | None:
    """Return every rectangle of a scene that has nothing else, with the target at a pose; else nothing.

    What Mitsuba's scene has of lamps is the same: panels, or lights that are no surface.
    """
    solid = bodies(scene, T_world_target)
    if (
        not scene.board.bend.is_flat
        or any(isinstance(lamp, Ring) for lamp in scene.lamps)
        or any(body.facets.normals is not None for body in solid.values())
    ):
        return None
    found = [("print", print_pose(scene, T_world_target)), *_room_places(scene).items()]
    for name, body in solid.items():
        found += [(name, place) for place in body.facets.rectangles(body.T_world_body)]
    for number, lamp in enumerate(scene.lamps):
        if isinstance(lamp, Panel):
            found.append((f"lamp-{number}", _panel_place(lamp)))
    names, places = zip(*found, strict=True)
    return FlatPlaces(names, places)


def _lamp(mi: ModuleType, name: str, lamp: Lamp, paint: Paint) -> dict[str, Any]:
    """Return a lamp; light from everywhere is no part of Mitsuba's scene."""
    if isinstance(lamp, Spot):
        return {
            name: {
                "type": "spot",
                "to_world": mi.ScalarTransform4f(lamp_pose(lamp)),
                "intensity": paint.spectrum(lamp.colour, lamp.intensity),
                "cutoff_angle": lamp.cutoff_deg,
                "beam_width": lamp.beam_deg,
            }
        }
    inside: dict[str, Any] = {"bsdf": paint.matt(BLACK)}
    if isinstance(lamp, Panel):
        inside["emitter"] = {"type": "area", "radiance": paint.spectrum(lamp.colour, lamp.radiance)}
        return {name: _rectangle(mi, _panel_place(lamp), inside)}
    if isinstance(lamp, Ring):
        inside["emitter"] = {"type": "area", "radiance": paint.spectrum(lamp.colour, lamp.radiance)}
        facets = ring_facets(lamp.inner_diameter_mm, lamp.outer_diameter_mm)
        return {name: facets.mesh(mi, name, lamp_pose(lamp), inside)}
    return {}
