"""The solid things around the target in a view: the table, the target's plate, and what holds it up."""

from dataclasses import dataclass

import numpy as np

from labcal.arrays import Pose
from labcal.geometry.poses import pose
from labcal.scene.model import Scene
from labcal.scene.placement import Stage
from labcal.scene.room import Colour

TABLE_THICKNESS_MM = 40.0
COLUMN_MM = 220.0
"""Side of the lifting column that carries the target on a stage."""
ARM_MM = (45.0, 45.0, 500.0)
"""The arm behind a target in the hand."""
GAP_MM = 0.05
"""The print lies this far above its plate, so that no ray confuses the two."""


@dataclass(frozen=True)
class Block:
    """A box of one reflectance."""

    T_world_block: Pose
    """Pose of its middle, mm."""
    size_mm: tuple[float, float, float]
    reflectance: Colour


def blocks(scene: Scene, T_world_target: Pose) -> tuple[Block, Block, Block]:
    """Return table, plate and support with the target at a pose; none of them hides the print.

    Parameters
    ----------
    scene : Scene
    T_world_target : ndarray, shape (4, 4)
        True pose of the target, mm.
    """
    room = scene.room
    table = pose(np.eye(3), np.array([*room.table_centre_mm, room.table_z_mm - 0.5 * TABLE_THICKNESS_MM]))
    x_min, y_min, x_max, y_max = scene.target.extent_mm
    middle = np.array([0.5 * (x_min + x_max), 0.5 * (y_min + y_max), 0.0])
    thickness = scene.board.thickness_mm
    plate = T_world_target @ pose(np.eye(3), middle - [0.0, 0.0, 0.5 * thickness + GAP_MM])
    underside = T_world_target @ pose(np.eye(3), middle - [0.0, 0.0, thickness + GAP_MM])
    if isinstance(scene.placement, Stage):
        height = max(float(underside[2, 3]) - room.table_z_mm, 1.0)
        support = pose(np.eye(3), underside[:3, 3] - [0.0, 0.0, 0.5 * height])
        support_size = (COLUMN_MM, COLUMN_MM, height)
    else:
        support = underside @ pose(np.eye(3), np.array([0.0, 0.0, -0.5 * ARM_MM[2]]))
        support_size = ARM_MM
    return (
        Block(table, (*room.table_size_mm, TABLE_THICKNESS_MM), room.table),
        Block(plate, (x_max - x_min, y_max - y_min, thickness), scene.board.plate),
        Block(support, support_size, room.support),
    )
