"""``points.csv``: reconstructed points, a line a dot."""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np
from jaxtyping import Int64

from labcal.arrays import PointCovariances, Points
from labcal.run.claims import beginning_with
from labcal.run.tables import damaged_line, read_table, table_text

HEADER = (
    "view", "col", "row", "X_mm", "Y_mm", "Z_mm",
    "cov_xx", "cov_xy", "cov_xz", "cov_yy", "cov_yz", "cov_zz", "flag",
)  # fmt: skip
KIND = beginning_with("a table of points", ",".join(HEADER[:3]).encode())
_UPPER = ([0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2])


class PointFlag(StrEnum):
    """What to think of a point."""

    OK = "ok"
    """Reconstructed."""
    EXTRAPOLATED = "extrapolated"
    """Outside the volume that the method was trained in."""
    MODEL_MISFIT = "model-misfit"
    """The method is known to err by far more than the noise leaves, or by more than its covariances say."""
    NO_SOLUTION = "no-solution"
    """The pixels determine no point."""


@dataclass(frozen=True)
class ReconstructedPoints:
    """Points in columns of equal length, in the frame of the model."""

    view: np.ndarray
    """(n,) of str"""
    index: Int64[np.ndarray, "n 2"]
    """(col, row)"""
    point: Points
    """(n, 3), mm; NaN where there is none."""
    covariance: PointCovariances
    """(n, 3, 3), mm squared; NaN where the method states none."""
    flag: np.ndarray
    """(n,) of str, a :class:`PointFlag`."""

    def __len__(self) -> int:
        return len(self.view)

    def where(self, mask: np.ndarray) -> "ReconstructedPoints":
        """Return the lines where the mask holds."""
        return ReconstructedPoints(
            self.view[mask], self.index[mask], self.point[mask], self.covariance[mask], self.flag[mask]
        )


def points_csv(points: ReconstructedPoints) -> str:
    """Return the text of ``points.csv``; figures are written so that they read back exactly."""
    return table_text(
        HEADER,
        (
            [points.view[i], *points.index[i].tolist(), *points.point[i].tolist(),
             *points.covariance[i][_UPPER].tolist(), points.flag[i]]
            for i in range(len(points))
        ),
    )  # fmt: skip


def read_points(path: Path) -> ReconstructedPoints:
    """Read ``points.csv``.

    Raises
    ------
    InputError
        It cannot be read, has other columns, or a line in it is damaged; the line is named.
    """
    lines = read_table(HEADER, "points", path)
    flags = {flag.value for flag in PointFlag}
    index = np.zeros((len(lines), 2), dtype=np.int64)
    figures = np.full((len(lines), 9), np.nan)
    for i, line in enumerate(lines):
        try:
            _, col, row, X, Y, Z, xx, xy, xz, yy, yz, zz, flag = line
            index[i] = [int(col), int(row)]
            figures[i] = [float(v) for v in (X, Y, Z, xx, xy, xz, yy, yz, zz)]
            known = flag in flags
        except (ValueError, OverflowError):
            known = False
        if not known:
            raise damaged_line(path, i, line)
    covariance = np.empty((len(figures), 3, 3))
    covariance[:, _UPPER[0], _UPPER[1]] = figures[:, 3:]
    covariance[:, _UPPER[1], _UPPER[0]] = figures[:, 3:]
    return ReconstructedPoints(
        view=np.array([line[0] for line in lines], dtype=np.str_),
        index=index,
        point=figures[:, :3],
        covariance=covariance,
        flag=np.array([line[-1] for line in lines], dtype=np.str_),
    )
