"""Tables of a rehearsal: the map of expected errors, and the recommended poses."""

import numpy as np

from labcal.geometry.poses import rotation_vector
from labcal.guide.rehearsal.rehearsal import Rehearsal
from labcal.report.page.download import Download, table_download

POSES_HEADER = ("view", "x_mm", "y_mm", "z_mm", "rx_rad", "ry_rad", "rz_rad")
_DIGITS = 6


def map_table(found: Rehearsal) -> Download:
    """Return ``map.csv``: a line for each point of the working volume, in the plan's frame."""
    columns = found.map_columns()
    return table_download("map.csv", list(columns), [_rounded(column) for column in columns.values()])


def poses_table(found: Rehearsal) -> Download:
    """Return ``poses.csv``: place and rotation vector of the target in the frame of the first camera."""
    rows = np.array([[*T[:3, 3], *rotation_vector(T)] for T in found.views])
    names = [f"pose-{number:02d}" for number in range(1, len(rows) + 1)]
    return table_download("poses.csv", POSES_HEADER, [names, *(_rounded(column) for column in rows.T)])


def _rounded(values: np.ndarray) -> list[float]:
    found: list[float] = np.round(values, _DIGITS).tolist()
    return found
