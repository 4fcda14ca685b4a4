"""Readings of a stage: the pose of the target in each view, from a table."""

from dataclasses import dataclass
from math import isfinite
from pathlib import Path

import numpy as np

from labcal.arrays import Pose
from labcal.errors import InputError
from labcal.geometry.poses import from_fixed_angles_deg, pose
from labcal.paths import AnyPath, as_path
from labcal.run.decimal_words import decimal
from labcal.run.names import differ_in_case, is_name
from labcal.run.tables import damaged_line, read_table
from labcal.shoot.manifest import Role

HEADER = ("view", "role", "X_mm", "Y_mm", "Z_mm", "rx_deg", "ry_deg", "rz_deg")
"""Place of the target's origin in the world, and its rotation about the fixed axes x, y and z."""


@dataclass(frozen=True)
class StageView:
    """One reading."""

    view: str
    """Name of the view."""
    role: Role
    """Use of the view."""
    T_world_target: Pose
    """Pose of the target as the stage states it, (4, 4), mm."""


def read_stage(path: AnyPath) -> tuple[StageView, ...]:
    """Read the readings of a stage, one line a view, in the order in which the views are taken.

    Parameters
    ----------
    path : str or os.PathLike
        A CSV file with the columns of :data:`HEADER`.

    Raises
    ------
    InputError
        It cannot be read, has other columns or no line, a line is damaged, or two are of the same view.
    """
    path = as_path(path)
    views = [_reading(path, number, line) for number, line in enumerate(read_table(HEADER, "poses", path))]
    names = [one.view for one in views]
    if not views:
        raise InputError(f"{path} has no poses. Write one line for each view.")
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"{path} has two lines of the view '{twice}'. Give each view a name of its own.")
    alike = differ_in_case(names)
    if alike is not None:
        raise InputError(f"The views '{alike[0]}' and '{alike[1]}' of {path} differ only in capital letters.")
    return tuple(views)


def _reading(path: Path, number: int, line: list[str]) -> StageView:
    """Return one line as a reading."""
    view, role, *figures = line
    if not is_name(view):
        raise damaged_line(path, number, line, "a view's name has letters, digits and hyphens")
    if role not in {one.value for one in Role}:
        raise damaged_line(path, number, line, "the role is train or test")
    try:
        values = [decimal(figure) for figure in figures]
    except ValueError:
        values = []
    if len(values) != len(figures) or not all(map(isfinite, values)):
        raise damaged_line(path, number, line, "places and angles are numbers")
    return StageView(view, Role(role), pose(from_fixed_angles_deg(values[3:]), np.array(values[:3])))
