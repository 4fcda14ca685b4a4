"""The shapes of a laboratory by name: flat rectangles with their poses in a view, and other bodies."""

from dataclasses import dataclass

import numpy as np

from labcal.arrays import Pose
from labcal.geometry.poses import pose
from labcal.render.facets import Facets, cylinder_facets, ring_facets, sheet_facets
from labcal.scene.furniture import blocks, obstacles
from labcal.scene.lamps import Panel, Ring
from labcal.scene.lighting import lamp_pose
from labcal.scene.model import Scene
from labcal.scene.quantities import Colour
from labcal.scene.solids import Block
from labcal.scene.surface import Surface

FAR_MM = 12000.0
"""Extent of floor and wall."""
NEAR_MM = 200.0
"""A camera this near to the plane of a face counts as seeing it."""


def _face(x: tuple[int, int, int], y: tuple[int, int, int]) -> Pose:
    """Return the face of a cube from -1 to 1 with these edges."""
    normal = np.cross(x, y)
    return pose(np.stack([x, y, normal], axis=1).astype(np.float64), normal.astype(np.float64))


FACES = {
    "top": _face((1, 0, 0), (0, 1, 0)),
    "right": _face((0, 1, 0), (0, 0, 1)),
    "left": _face((0, -1, 0), (0, 0, 1)),
    "back": _face((-1, 0, 0), (0, 0, 1)),
    "front": _face((1, 0, 0), (0, 0, 1)),
    "bottom": _face((1, 0, 0), (0, -1, 0)),
}
"""The faces of a block, seen from outside."""
SIDES = ("right", "left", "back", "front")


@dataclass(frozen=True)
class Flat:
    """A rectangle."""

    T_world_panel: np.ndarray
    """(4, 4), affine: takes the square from -1 to 1 into the world, mm; it faces +z."""
    colour: Colour | None = None
    """Its reflectance, where it has but one."""
    occludes: bool = True
    """True if it can hide a lamp from a surface; false for floor and wall."""


@dataclass(frozen=True)
class Body:
    """A body of triangles."""

    facets: Facets
    T_world_body: Pose
    colour: Colour | None = None
    """Its reflectance, where it has but one."""


Form = Flat | Body


def forms(scene: Scene, T_world_target: Pose) -> dict[str, Form]:
    """Return every shape of a scene with the target at a pose (mm), by name.

    Names and their order, and how many triangles a body has, are the same at all poses. Faces that no camera
    can see are left out, since each costs time on every ray.
    """
    surface = Surface.of_board(scene.target, scene.board)
    table, plate, support = blocks(scene, T_world_target)
    covered = support.size_mm[0] <= plate.size_mm[0] and support.size_mm[1] <= plate.size_mm[1]
    found: dict[str, Form] = {"print": _print(surface, T_world_target)} | _room(scene)
    found |= _faces("table", table, _seen_of_table(scene, table))
    found |= _faces("plate", plate, SIDES if surface.bend.is_flat else ("top", *SIDES))
    found |= _faces("support", support, SIDES if covered else ("top", *SIDES))
    for number, solid in enumerate(obstacles(scene, T_world_target)):
        name = f"occluder-{number}"
        if isinstance(solid, Block):
            found |= _faces(name, solid, tuple(FACES))
        else:
            facets = cylinder_facets(solid.length_mm, solid.diameter_mm)
            found[name] = Body(facets, solid.T_world_cylinder, solid.reflectance)
    for number, lamp in enumerate(scene.lamps):
        name = f"lamp-{number}"
        if isinstance(lamp, Panel):
            width, height = lamp.size_mm
            found[name] = Flat(lamp_pose(lamp) @ np.diag([0.5 * width, 0.5 * height, 1.0, 1.0]))
        elif isinstance(lamp, Ring):
            found[name] = Body(ring_facets(lamp.inner_diameter_mm, lamp.outer_diameter_mm), lamp_pose(lamp))
    return found


def _print(surface: Surface, T_world_target: Pose) -> Form:
    """Return the board's front: a rectangle where it is flat, else a fine mesh."""
    if not surface.bend.is_flat:
        return Body(sheet_facets(surface), T_world_target)
    middle = pose(np.eye(3), np.array([*surface.middle, 0.0]))
    return Flat(T_world_target @ middle @ np.diag([*surface.half, 1.0, 1.0]))


def floor_size_mm(scene: Scene) -> tuple[float, float]:
    """Return the floor's width and depth; it ends at the wall."""
    return 2.0 * FAR_MM, scene.room.wall_y_mm + FAR_MM


def wall_size_mm(scene: Scene) -> tuple[float, float]:
    """Return the wall's width and height; it begins at the floor."""
    return 2.0 * FAR_MM, FAR_MM - scene.room.floor_z_mm


def _room(scene: Scene) -> dict[str, Form]:
    """Return floor and wall."""
    floor_z, wall_y = scene.room.floor_z_mm, scene.room.wall_y_mm
    (_, depth), (_, height) = floor_size_mm(scene), wall_size_mm(scene)
    upright = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    on_floor = pose(np.eye(3), np.array([0.0, wall_y - 0.5 * depth, floor_z]))
    on_wall = pose(upright, np.array([0.0, wall_y, floor_z + 0.5 * height]))
    return {
        "floor": Flat(on_floor @ np.diag([FAR_MM, 0.5 * depth, 1.0, 1.0]), occludes=False),
        "wall": Flat(on_wall @ np.diag([FAR_MM, 0.5 * height, 1.0, 1.0]), occludes=False),
    }


def _faces(name: str, block: Block, which: tuple[str, ...]) -> dict[str, Form]:
    """Return some faces of a block."""
    size = np.diag([*(0.5 * np.array(block.size_mm)), 1.0])
    return {
        f"{name}-{face}": Flat(block.T_world_block @ size @ FACES[face], block.reflectance) for face in which
    }


def _seen_of_table(scene: Scene, table: Block) -> tuple[str, ...]:
    """Return the faces of the table towards the cameras; the top casts the whole shadow of the thin body."""
    size = np.diag([*(0.5 * np.array(table.size_mm)), 1.0])
    eyes = np.array([camera.eye_mm for camera in scene.cameras.values()])
    seen = []
    for name, T_block_face in FACES.items():
        face = table.T_world_block @ size @ T_block_face
        normal = np.cross(face[:3, 0], face[:3, 1])
        above = (eyes - face[:3, 3]) @ normal / np.linalg.norm(normal)
        if name == "top" or (above > -NEAR_MM).any():
            seen.append(name)
    return tuple(seen)
