"""The table of known points: their coordinates in a frame that the user names."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Vectors3
from labcal.bounds import MOST_MM
from labcal.run.file_reading import first_line
from labcal.run.table_columns import TableLines, table_parts
from labcal.run.tables import refuse_twice
from labcal.wording import has_control

HEADER = ("point", "X_mm", "Y_mm", "Z_mm", "sigma_mm")
"""The last column may be left out where the coordinates count as exact."""


@dataclass(frozen=True)
class KnownPoints:
    """Coordinates of named points in a frame."""

    name: tuple[str, ...]
    point: Vectors3
    """(n, 3), mm."""
    sigma_mm: Float64[np.ndarray, " n"]
    """Standard deviation of each coordinate, mm; 0 where it counts as exact."""


def read_known_points(path: Path) -> KnownPoints:
    """Read the table of known points.

    Raises
    ------
    InputError
        It cannot be read, has other columns, a line in it is damaged, or two are of the same point.
    """
    header = HEADER if b"sigma_mm" in first_line(path) else HEADER[:-1]
    names, figures = list[str](), [np.empty((0, 4))]
    for part in table_parts(header, "known points", path):
        figures.append(_figures(part))
        names += part.column("point")
    every = np.concatenate(figures)
    place = {name: number for number, name in enumerate(dict.fromkeys(names))}
    refuse_twice(path, np.array([[place[name]] for name in names], dtype=np.int64).reshape(-1, 1), "point")
    return KnownPoints(tuple(names), every[:, :3], every[:, 3])


def _figures(part: TableLines) -> Float64[np.ndarray, "n 4"]:
    """Return coordinates and standard deviations of lines; raise at a damaged one."""
    figures = part.figures(part.header[1:], empty="0")
    figures = np.column_stack([figures, np.zeros((len(part), 4 - figures.shape[1]))])
    part.require(
        np.array([name != "" and not has_control(name) for name in part.column("point")]), "it names no point"
    )
    part.require(np.array([all(line[1:4]) for line in part.lines]), "it has no coordinates")
    part.require((np.abs(figures[:, :3]) <= MOST_MM).all(axis=1), f"coordinates are at most {MOST_MM:g} mm")
    part.require((figures[:, 3] >= 0) & (figures[:, 3] <= MOST_MM), "sigma_mm is no standard deviation")
    part.refuse()
    return figures
