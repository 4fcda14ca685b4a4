"""``points.csv``: its columns, read line by line with checks, and written."""

from itertools import islice
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from labcal.arguments import choice_of, object_of
from labcal.bounds import MOST_INDEX, MOST_MM
from labcal.correspond.points import PointFlag, Points
from labcal.errors import InputError
from labcal.geometry.covariances import valid_or_not_stated
from labcal.paths import AnyPath, as_path
from labcal.run.file_kinds import beginning_with
from labcal.run.file_reading import first_line
from labcal.run.names import is_name
from labcal.run.outputs import write_file
from labcal.run.table_columns import TableLines, names_of_lines, numbers_of_names, table_parts
from labcal.run.tables import refuse_twice, table_text
from labcal.wording import clipped, has_control, printable

HEADER = (
    "view", "col", "row", "X_mm", "Y_mm", "Z_mm",
    "cov_xx", "cov_xy", "cov_xz", "cov_yy", "cov_yz", "cov_zz", "flag",
)  # fmt: skip
BOARD = "board"
"""A further column where views show several boards: the name of the board that col and row are of."""
_OF_BOARDS = (*HEADER, BOARD)
UPPER = ([0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2])
"""Rows and columns of a covariance's elements, in the order of the columns."""

KIND = beginning_with(
    "a table of points", *(f"{','.join(columns)}\n".encode() for columns in (HEADER, _OF_BOARDS))
)


def points_csv(points: Points) -> str:
    """Return the text of ``points.csv``; figures are written so that they read back exactly."""
    lines = (
        [points.view[i], *points.index[i].tolist(), *points.point[i].tolist(),
         *points.covariance[i][UPPER].tolist(), points.flag[i]]
        for i in range(len(points))
    )  # fmt: skip
    if not points.boards:
        return table_text(HEADER, lines)
    boards = map(str, points.board)
    return table_text(_OF_BOARDS, ([*line, board] for line, board in zip(lines, boards, strict=True)))


def read_points(path: AnyPath) -> Points:
    """Read ``points.csv``.

    Parameters
    ----------
    path : str or os.PathLike
        The file.

    Returns
    -------
    Points

    Raises
    ------
    InputError
        It cannot be read, has other columns, a line in it is damaged, or two are of the same dot of a view;
        the line is named.

    Examples
    --------
    >>> from labcal import examples, read_points
    >>> examples.points().save("points.csv")
    >>> read_points("points.csv")
    Points(views=8, points=704, ok=704, median_sigma=0.076 mm)
    """
    return Points(*_read_columns(as_path(path)))


def write_points(path: AnyPath, points: Points, *, force: bool = False) -> None:
    """Write ``points.csv``.

    Parameters
    ----------
    path : str or os.PathLike
        The file to appear.
    points : Points
        What to write.
    force : bool
        Replace a table of points that exists.

    Raises
    ------
    InputError, InputTypeError
        These are no points, or a name or flag in them could not be read again.
    OutputError
        The file exists and `force` is not set, or it cannot be written.

    Examples
    --------
    >>> from labcal import examples, read_points, write_points
    >>> write_points("points.csv", examples.points())
    >>> read_points("points.csv") == examples.points()
    True
    """
    points = object_of(points, Points, "points")
    for name in dict.fromkeys(points.view.tolist()):
        if has_control(name):
            raise InputError(
                f"The view '{clipped(printable(name))}' cannot be written to a table. Give it a name of "
                "printable characters."
            )
    for name in points.boards:
        if not is_name(name):
            raise InputError(
                f"The board '{clipped(printable(name))}' cannot be written to a table. Give it a name of "
                "letters, digits and hyphens."
            )
    for flag in dict.fromkeys(points.flag.tolist()):
        choice_of(flag, PointFlag, "flag")
    write_file(as_path(path), points_csv(points), kind=KIND, force=force)


def _read_columns(path: Path) -> tuple[np.ndarray, ...]:
    """Read the columns of ``points.csv``, in the order of `Points`.

    Raises
    ------
    InputError
        It cannot be read, has other columns, a line in it is damaged, or two are of the same dot of a view;
        the line is named.
    """
    views: dict[str, int] = {}
    # The name of the board is among the columns where it is stated.
    header = _OF_BOARDS if first_line(path).rstrip(b"\r\n").endswith(f",{BOARD}".encode()) else HEADER
    read = [_columns(part, views) for part in table_parts(header, "points", path)]
    view, index, figures, flag, board = (
        (np.concatenate(column) for column in zip(*read, strict=True)) if read else _NO_LINES
    )
    number = numbers_of_names(board.tolist(), {})
    refuse_twice(path, np.column_stack([view, index + MOST_INDEX, number]), "dot of a view")
    return (
        names_of_lines(path, list(views), view),
        index,
        figures[:, :3],
        matrices(figures[:, 3:]),
        flag,
        board,
    )


_NO_LINES = (
    np.empty(0, dtype=np.int64),
    np.empty((0, 2), dtype=np.int64),
    np.empty((0, 9)),
    np.empty(0, dtype=np.str_),
    np.empty(0, dtype=np.str_),
)


def _columns(part: TableLines, views: dict[str, int]) -> tuple[np.ndarray, ...]:
    """Return number of the view, (col, row), figures, flag and board of lines; raise at a damaged one."""
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
    part.require(valid_or_not_stated(matrices(figures[:, 3:]), MOST_MM**2), "its covariance is none")
    board = np.full(len(part), "", dtype=object)
    if BOARD in part.header:
        board = np.array(part.column(BOARD), dtype=object)
        named = np.array([is_name(name) for name in board])
        part.require(named, "its board should be a name of letters, digits and hyphens")
    part.refuse()
    return view, index, figures, flag.astype(np.str_), board.astype(np.str_)


def matrices(upper: Float64[np.ndarray, "n 6"]) -> Float64[np.ndarray, "n 3 3"]:
    """Return symmetric matrices from their upper triangles."""
    covariance = np.empty((len(upper), 3, 3))
    covariance[:, UPPER[0], UPPER[1]] = upper
    covariance[:, UPPER[1], UPPER[0]] = upper
    return covariance


_FLAGS = frozenset(flag.value for flag in PointFlag)
