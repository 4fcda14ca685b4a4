"""``points.csv``: reconstructed points, a line a dot."""

from dataclasses import dataclass
from enum import StrEnum
from itertools import islice
from pathlib import Path

import numpy as np
from jaxtyping import Float64, Int64

from labcal.arrays import PointCovariances, Vectors3
from labcal.bounds import MOST_INDEX, MOST_MM
from labcal.geometry.covariances import valid_or_not_stated
from labcal.run.file_kinds import beginning_with
from labcal.run.table_columns import TableLines, names_of_lines, table_parts
from labcal.run.tables import refuse_twice, table_text
from labcal.wording import has_control

HEADER = (
    "view", "col", "row", "X_mm", "Y_mm", "Z_mm",
    "cov_xx", "cov_xy", "cov_xz", "cov_yy", "cov_yz", "cov_zz", "flag",
)  # fmt: skip
KIND = beginning_with("a table of points", f"{','.join(HEADER)}\n".encode())
_UPPER = ([0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2])


class PointFlag(StrEnum):
    """The state of a point."""

    OK = "ok"
    """Reconstructed."""
    EXTRAPOLATED = "extrapolated"
    """Outside the volume that the method was trained in."""
    MODEL_MISFIT = "model-misfit"
    """The method is known to err by far more than the noise leaves, or by more than its covariances say."""
    NO_SOLUTION = "no-solution"
    """The pixels determine no point."""


@dataclass(frozen=True)
class Points:
    """Points in columns of equal length, in the frame of the model."""

    view: np.ndarray
    """(n,) of str"""
    index: Int64[np.ndarray, "n 2"]
    """(col, row)"""
    point: Vectors3
    """(n, 3), mm; NaN where there is none."""
    covariance: PointCovariances
    """(n, 3, 3), mm squared; NaN where the method states none."""
    flag: np.ndarray
    """(n,) of str, a :class:`PointFlag`."""

    def __len__(self) -> int:
        return len(self.view)

    def where(self, mask: np.ndarray) -> "Points":
        """Return the lines where the mask holds."""
        return Points(
            self.view[mask], self.index[mask], self.point[mask], self.covariance[mask], self.flag[mask]
        )


def points_csv(points: Points) -> str:
    """Return the text of ``points.csv``; figures are written so that they read back exactly."""
    return table_text(
        HEADER,
        (
            [points.view[i], *points.index[i].tolist(), *points.point[i].tolist(),
             *points.covariance[i][_UPPER].tolist(), points.flag[i]]
            for i in range(len(points))
        ),
    )  # fmt: skip


def read_points(path: Path) -> Points:
    """Read ``points.csv``.

    Raises
    ------
    InputError
        It cannot be read, has other columns, a line in it is damaged, or two are of the same dot of a view;
        the line is named.
    """
    views: dict[str, int] = {}
    read = [_columns(part, views) for part in table_parts(HEADER, "points", path)]
    view, index, figures, flag = (
        (np.concatenate(column) for column in zip(*read, strict=True)) if read else _NO_LINES
    )
    refuse_twice(path, np.column_stack([view, index + MOST_INDEX]), "dot of a view")
    return Points(
        view=names_of_lines(path, list(views), view),
        index=index,
        point=figures[:, :3],
        covariance=_matrices(figures[:, 3:]),
        flag=flag,
    )


_NO_LINES = (
    np.empty(0, dtype=np.int64),
    np.empty((0, 2), dtype=np.int64),
    np.empty((0, 9)),
    np.empty(0, dtype=np.str_),
)


def _columns(
    part: TableLines, views: dict[str, int]
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return number of the view, (col, row), figures and flag of lines; raise at a damaged one."""
    names = part.column("view")
    known = len(views)
    view = np.array([views.setdefault(name, len(views)) for name in names], dtype=np.int64)
    hidden = [number for number, name in enumerate(islice(views, known, None), known) if has_control(name)]
    index, figures = part.whole(("col", "row")), part.figures(HEADER[3:12])
    flag = np.array(part.column("flag"), dtype=object)  # of any length until it is known
    part.require(~np.isin(view, hidden), "the view's name has control characters")
    part.require(np.isin(flag, list(_FLAGS)), f"its flag should be one of {', '.join(sorted(_FLAGS))}")
    part.require((np.abs(index) <= MOST_INDEX).all(axis=1), f"col and row are at most {MOST_INDEX}")
    missing = (flag == PointFlag.NO_SOLUTION.value) & np.isnan(figures[:, :3]).all(axis=1)
    near = (np.abs(figures[:, :3]) <= MOST_MM).all(axis=1)
    part.require(missing | near, f"coordinates are numbers of at most {MOST_MM:g} mm")
    part.require(valid_or_not_stated(_matrices(figures[:, 3:]), MOST_MM**2), "its covariance is none")
    part.refuse()
    return view, index, figures, flag.astype(np.str_)


def _matrices(upper: Float64[np.ndarray, "n 6"]) -> Float64[np.ndarray, "n 3 3"]:
    """Return symmetric matrices from their upper triangles."""
    covariance = np.empty((len(upper), 3, 3))
    covariance[:, _UPPER[0], _UPPER[1]] = upper
    covariance[:, _UPPER[1], _UPPER[0]] = upper
    return covariance


_FLAGS = frozenset(flag.value for flag in PointFlag)
