"""``points.csv`` of named points: its columns, read line by line with checks, and written."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float64, Int64

from labcal.arguments import choice_of, object_of
from labcal.bounds import MOST_MM
from labcal.correspond.named_pixels_csv import MOST_BYTES, MOST_LETTERS
from labcal.correspond.named_points import NamedPoints
from labcal.correspond.points import PointFlag
from labcal.correspond.points_csv import UPPER, matrices
from labcal.errors import InputError
from labcal.geometry.covariances import valid_or_not_stated
from labcal.paths import AnyPath, as_path
from labcal.run.file_kinds import beginning_with
from labcal.run.outputs import write_file
from labcal.run.table_columns import TableLines, names_of_lines, numbers_of_names, table_parts
from labcal.run.tables import columns_text, refuse_twice
from labcal.wording import clipped, has_control, printable

HEADER = (
    "view", "point", "X_mm", "Y_mm", "Z_mm",
    "cov_xx", "cov_xy", "cov_xz", "cov_yy", "cov_yz", "cov_zz", "flag",
)  # fmt: skip
KIND = beginning_with("a table of named points", f"{','.join(HEADER)}\n".encode())
WITHOUT_PLACE = frozenset((PointFlag.NO_SOLUTION, PointFlag.TOO_FEW_CAMERAS, PointFlag.OUTSIDE_PICTURE))
"""Flags of lines whose coordinates may be missing."""
_BLOCK = 2**14


def named_points_csv(points: NamedPoints) -> str:
    """Return the text of the table; figures are written so that they read back exactly."""
    return columns_text(HEADER, _parts(points))


def _parts(points: NamedPoints) -> Iterator[list[list[object] | np.ndarray]]:
    """Yield the columns of some lines of the table after the others."""
    for first in range(0, len(points), _BLOCK):
        part = slice(first, first + _BLOCK)
        figures = np.column_stack([points.point[part], points.covariance[part][:, UPPER[0], UPPER[1]]])
        names = (points.view[part].tolist(), points.name[part].tolist())
        yield [*names, *figures.T, points.flag[part].tolist()]


def read_named_points(path: AnyPath) -> NamedPoints:
    """Read a ``points.csv`` of named points, as ``labcal measure`` writes it.

    Parameters
    ----------
    path : str or os.PathLike
        The file.

    Returns
    -------
    NamedPoints

    Raises
    ------
    InputError
        It cannot be read, has other columns, a line in it is damaged, or two are of the same point of a view;
        the line is named.

    Examples
    --------
    >>> from labcal import examples, pipeline, read_named_points
    >>> pipeline.measure(examples.rig(), examples.pixels()).save("points.csv")
    >>> read_named_points("points.csv")
    NamedPoints(views=1, points=5, ok=5, median_sigma=0.0719 mm)
    """
    place = as_path(path)
    views, names = dict[str, int](), dict[str, int]()
    read = [_columns(part, views, names) for part in table_parts(HEADER, "named points", place, MOST_BYTES)]
    numbers, figures, flag = (
        (np.concatenate(column) for column in zip(*read, strict=True))
        if read
        else (np.empty((0, 2), dtype=np.int64), np.empty((0, 9)), np.empty(0, dtype=np.str_))
    )
    refuse_twice(place, numbers, "point of a view")
    return NamedPoints(
        names_of_lines(place, list(views), numbers[:, 0]),
        names_of_lines(place, list(names), numbers[:, 1]),
        figures[:, :3],
        matrices(figures[:, 3:]),
        flag,
    )


def write_named_points(path: AnyPath, points: NamedPoints, *, force: bool = False) -> None:
    """Write named points; as :meth:`NamedPoints.save`, which lists its errors."""
    points = object_of(points, NamedPoints, "points")
    for column, names in (("view", points.view), ("point", points.name)):
        for name in dict.fromkeys(names.tolist()):
            if not _is_readable(name):
                raise InputError(
                    f"The {column} '{clipped(printable(name))}' cannot be written to a table. Give it a name "
                    f"of 1 to {MOST_LETTERS} printable characters."
                )
    for flag in dict.fromkeys(points.flag.tolist()):
        choice_of(flag, PointFlag, "flag")
    write_file(as_path(path), named_points_csv(points), kind=KIND, force=force)


def _is_readable(name: str) -> bool:
    return 1 <= len(name) <= MOST_LETTERS and not has_control(name)


def _columns(
    part: TableLines, views: dict[str, int], names: dict[str, int]
) -> tuple[Int64[np.ndarray, "n 2"], Float64[np.ndarray, "n 9"], np.ndarray]:
    """Return numbers of view and point, figures and flag of lines; raise at a damaged one."""
    numbers = np.column_stack([_numbers(part, "view", views), _numbers(part, "point", names)])
    figures = part.figures(HEADER[2:11])
    flag = np.array(part.column("flag"), dtype=object)  # of any length until it is known
    part.require(np.isin(flag, list(_FLAGS)), f"its flag should be one of {', '.join(sorted(_FLAGS))}")
    missing = np.isin(flag, list(WITHOUT_PLACE)) & np.isnan(figures[:, :3]).all(axis=1)
    near = (np.abs(figures[:, :3]) <= MOST_MM).all(axis=1)
    part.require(missing | near, f"coordinates are numbers of at most {MOST_MM:g} mm")
    part.require(valid_or_not_stated(matrices(figures[:, 3:]), MOST_MM**2), "its covariance is none")
    part.refuse()
    return numbers, figures, flag.astype(np.str_)


def _numbers(part: TableLines, column: str, known: dict[str, int]) -> Int64[np.ndarray, " n"]:
    cells = part.column(column)
    readable = np.array([_is_readable(name) for name in cells])
    part.require(readable, f"the {column}'s name has 1 to {MOST_LETTERS} printable characters")
    return numbers_of_names(cells, known)


_FLAGS = frozenset(flag.value for flag in PointFlag)
