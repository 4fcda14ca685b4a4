"""Solid bodies around the target in a view: table, plate, support and occluders."""

import numpy as np

from labcal.arrays import Pose
from labcal.geometry.poses import facing, from_fixed_angles_deg, pose
from labcal.scene.model import Scene
from labcal.scene.occluders import Box, Frame, Occluder
from labcal.scene.placement import Stage
from labcal.scene.solids import Block, Cylinder, Solid
from labcal.scene.surface import Surface

TABLE_THICKNESS_MM = 40.0
COLUMN_MM = 220.0
"""Side of the lifting column that carries the target on a stage."""
ARM_MM = (45.0, 45.0, 500.0)
"""The arm behind a target in the hand."""
GAP_MM = 0.05
"""The print lies this far above its plate, so that no ray confuses the two."""


def blocks(scene: Scene, T_world_target: Pose) -> tuple[Block, Block, Block]:
    """Return table, plate and support with the target at a pose; none of them hides the print.

    The plate is flat, and so behind the lowest part of a bent print.

    Parameters
    ----------
    scene : Scene
    T_world_target : ndarray, shape (4, 4)
        True pose of the target, mm.
    """
    room = scene.room
    table = pose(np.eye(3), np.array([*room.table_centre_mm, room.table_z_mm - 0.5 * TABLE_THICKNESS_MM]))
    surface = Surface.of_board(scene.target, scene.board)
    thickness = scene.board.thickness_mm
    top = np.array([*surface.middle, surface.lowest_mm() - GAP_MM])
    plate = T_world_target @ pose(np.eye(3), top - [0.0, 0.0, 0.5 * thickness])
    underside = T_world_target @ pose(np.eye(3), top - [0.0, 0.0, thickness])
    if isinstance(scene.placement, Stage):
        height = max(float(underside[2, 3]) - room.table_z_mm, 1.0)
        support = pose(np.eye(3), underside[:3, 3] - [0.0, 0.0, 0.5 * height])
        support_size = (COLUMN_MM, COLUMN_MM, height)
    else:
        support = underside @ pose(np.eye(3), np.array([0.0, 0.0, -0.5 * ARM_MM[2]]))
        support_size = ARM_MM
    width, height = 2.0 * surface.half
    return (
        Block("the table", table, (*room.table_size_mm, TABLE_THICKNESS_MM), room.table),
        Block("the target's plate", plate, (width, height, thickness), scene.board.plate),
        Block("the target's support", support, support_size, room.support),
    )


def obstacles(scene: Scene, T_world_target: Pose) -> tuple[Solid, ...]:
    """Return the occluders of the scene in their order, with the target at a pose."""
    return tuple(
        solid_body(f"occluders.{number}", occluder, T_world_target)
        for number, occluder in enumerate(scene.occluders)
    )


def solid_body(name: str, occluder: Occluder, T_world_target: Pose) -> Solid:
    """Return an occluder at its place."""
    T_world_frame = T_world_target if occluder.frame is Frame.TARGET else np.eye(4)
    if isinstance(occluder, Box):
        turn = from_fixed_angles_deg(occluder.turn_deg)
        T_world_block = T_world_frame @ pose(turn, np.array(occluder.centre_mm))
        return Block(name, T_world_block, occluder.size_mm, occluder.reflectance)
    start, end = np.array(occluder.from_mm), np.array(occluder.to_mm)
    middle, length = 0.5 * (start + end), float(np.linalg.norm(end - start))
    T_world_cylinder = T_world_frame @ facing(middle, end)
    return Cylinder(name, T_world_cylinder, length, occluder.diameter_mm, occluder.reflectance)
