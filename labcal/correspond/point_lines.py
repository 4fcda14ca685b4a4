"""The lines of ``points.csv``, checked one by one."""

from enum import StrEnum
from itertools import islice
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from labcal.bounds import MOST_INDEX, MOST_MM
from labcal.geometry.covariances import valid_or_not_stated
from labcal.run.table_columns import TableLines, names_of_lines, table_parts
from labcal.run.tables import refuse_twice
from labcal.wording import has_control

HEADER = (
    "view", "col", "row", "X_mm", "Y_mm", "Z_mm",
    "cov_xx", "cov_xy", "cov_xz", "cov_yy", "cov_yz", "cov_zz", "flag",
)  # fmt: skip
UPPER = ([0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2])
"""Rows and columns of a covariance's elements, in the order of the columns."""


class PointFlag(StrEnum):
    """Flag of a reconstructed point."""

    OK = "ok"
    """Reconstructed."""
    EXTRAPOLATED = "extrapolated"
    """Outside the volume that the method was trained in."""
    MODEL_MISFIT = "model-misfit"
    """The method is known to err by far more than the noise leaves, or by more than its covariances say."""
    NO_SOLUTION = "no-solution"
    """The pixels determine no point."""


def read_columns(path: Path) -> tuple[np.ndarray, ...]:
    """Read the columns of ``points.csv``, in the order of `Points`.

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
    return (
        names_of_lines(path, list(views), view),
        index,
        figures[:, :3],
        _matrices(figures[:, 3:]),
        flag,
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
    covariance[:, UPPER[0], UPPER[1]] = upper
    covariance[:, UPPER[1], UPPER[0]] = upper
    return covariance


_FLAGS = frozenset(flag.value for flag in PointFlag)
