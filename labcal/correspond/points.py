"""``points.csv``: reconstructed points, a line a dot."""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np
from jaxtyping import Int64

from labcal.arrays import PointCovariances, Points
from labcal.bounds import MOST_INDEX, MOST_MM
from labcal.geometry.covariances import stated_soundly
from labcal.run.file_kinds import beginning_with
from labcal.run.tables import damaged_line, read_table, refuse_twice, table_text
from labcal.wording import has_control

HEADER = (
    "view", "col", "row", "X_mm", "Y_mm", "Z_mm",
    "cov_xx", "cov_xy", "cov_xz", "cov_yy", "cov_yz", "cov_zz", "flag",
)  # fmt: skip
KIND = beginning_with("a table of points", f"{','.join(HEADER)}\n".encode())
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
        It cannot be read, has other columns, a line in it is damaged, or two are of the same dot of a view;
        the line is named.
    """
    lines = read_table(HEADER, "points", path)
    flags = {flag.value for flag in PointFlag}
    index = np.zeros((len(lines), 2), dtype=np.int64)
    figures = np.full((len(lines), 9), np.nan)
    for i, line in enumerate(lines):
        try:
            view, col, row, X, Y, Z, xx, xy, xz, yy, yz, zz, flag = line
            index[i] = [int(col), int(row)]
            figures[i] = [float(v) for v in (X, Y, Z, xx, xy, xz, yy, yz, zz)]
            sound = flag in flags and not has_control(view) and np.abs(index[i]).max() <= MOST_INDEX
        except (ValueError, OverflowError):
            sound = False
        place = figures[i, :3]
        missing = flag == PointFlag.NO_SOLUTION.value and np.isnan(place).all() if sound else False
        if not sound or not (missing or np.all(np.abs(place) <= MOST_MM)):
            raise damaged_line(path, i, line)
    covariance = np.empty((len(figures), 3, 3))
    covariance[:, _UPPER[0], _UPPER[1]] = figures[:, 3:]
    covariance[:, _UPPER[1], _UPPER[0]] = figures[:, 3:]
    unsound = ~stated_soundly(covariance, MOST_MM**2)
    if unsound.any():
        at = int(np.argmax(unsound))
        raise damaged_line(path, at, lines[at], "its covariance is none")
    refuse_twice(
        path, [(line[0], *place) for line, place in zip(lines, index.tolist(), strict=True)], "dot of a view"
    )
    return ReconstructedPoints(
        view=np.array([line[0] for line in lines], dtype=np.str_),
        index=index,
        point=figures[:, :3],
        covariance=covariance,
        flag=np.array([line[-1] for line in lines], dtype=np.str_),
    )
