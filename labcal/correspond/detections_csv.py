"""``detections.csv``: its columns, read line by line with checks, and written."""

from pathlib import Path

import numpy as np

from labcal.arguments import choice_of, object_of
from labcal.bounds import MOST_INDEX
from labcal.correspond.detections import Detections
from labcal.correspond.sense import PicturesOfLines, covaries_soundly, near_picture
from labcal.detect.flags import DotFlag
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.run.file_kinds import beginning_with
from labcal.run.file_reading import first_line
from labcal.run.names import is_name
from labcal.run.outputs import write_file
from labcal.run.table_columns import TableLines, numbers_of_names, table_parts
from labcal.run.tables import refuse_twice, table_text
from labcal.wording import clipped, has_control, printable

HEADER = (
    "view", "camera", "image", "width_px", "height_px", "col", "row",
    "x_px", "y_px", "var_xx", "var_xy", "var_yy", "flag",
)  # fmt: skip

BOARD = "board"
"""A further column where pictures show several boards: the name of the board that col and row are of."""
_OF_BOARDS = (*HEADER, BOARD)

KIND = beginning_with(
    "a table of detections", *(f"{','.join(columns)}\n".encode() for columns in (HEADER, _OF_BOARDS))
)


def detections_csv(table: Detections) -> str:
    """Return the text of ``detections.csv``; figures are written so that they read back exactly."""
    lines = []
    for i in range(len(table)):
        index = table.index[i].tolist() if table.has_id[i] else ["", ""]
        (xx, xy), (_, yy) = table.covariance[i].tolist()
        lines.append(
            [table.view[i], table.camera[i], table.image[i], *table.size[i].tolist(), *index,
             *table.position[i].tolist(), xx, xy, yy, table.flag[i]]
        )  # fmt: skip
    if not table.boards:
        return table_text(HEADER, lines)
    return table_text(
        _OF_BOARDS, [[*line, str(board)] for line, board in zip(lines, table.board, strict=True)]
    )


def read_detections(path: AnyPath) -> Detections:
    """Read ``detections.csv``.

    Parameters
    ----------
    path : str or os.PathLike
        The file.

    Returns
    -------
    Detections

    Raises
    ------
    InputError
        It cannot be read, has other columns, a line in it is damaged, two lines are of the same dot of a
        picture, or a picture has two names or sizes; the line is named.

    Examples
    --------
    >>> from labcal import examples, read_detections
    >>> examples.detections().save("detections.csv")
    >>> read_detections("detections.csv")
    Detections(views=8, cameras=['left', 'right'], dots=1408, ok=1408)
    """
    return Detections(*_read_columns(as_path(path)))


def write_detections(path: AnyPath, table: Detections, *, force: bool = False) -> None:
    """Write ``detections.csv``.

    Parameters
    ----------
    path : str or os.PathLike
        The file to appear.
    table : Detections
        What to write.
    force : bool
        Replace a table of detections that exists.

    Raises
    ------
    InputError, InputTypeError
        It is no table of detections, or a name or flag in it could not be read again.
    OutputError
        The file exists and `force` is not set, or it cannot be written.

    Examples
    --------
    >>> from labcal import examples, read_detections, write_detections
    >>> write_detections("detections.csv", examples.detections())
    >>> read_detections("detections.csv") == examples.detections()
    True
    """
    table = object_of(table, Detections, "table")
    require_readable(table)
    write_file(as_path(path), detections_csv(table), kind=KIND, force=force)


def require_readable(table: Detections) -> None:
    """Raise where a table holds a word that :func:`read_detections` refuses.

    Raises
    ------
    InputError
        The name of a camera or view is no name, or a flag is not known; the first one is named.
    """
    cameras = [("camera", name, "letters, digits and hyphens") for name in table.cameras if not is_name(name)]
    cameras += [("board", name, "letters, digits and hyphens") for name in table.boards if not is_name(name)]
    views = [("view", name, "printable characters") for name in table.views if has_control(name)]
    for column, name, expected in (*cameras, *views):
        raise InputError(
            f"The {column} '{clipped(printable(name))}' cannot be written to a table. Give it a name of "
            f"{expected}."
        )
    for flag in dict.fromkeys(table.flag.tolist()):
        choice_of(flag, DotFlag, "flag")


def _read_columns(path: Path) -> tuple[np.ndarray, ...]:
    """Read the columns of ``detections.csv``, in the order of `Detections`.

    Raises
    ------
    InputError
        It cannot be read, has other columns, a line in it is damaged, two lines are of the same dot of a
        picture, or a picture has two names or sizes; the line is named.
    """
    first = first_line(path)
    if first.startswith(b"#") and path.suffix.lower() != ".csv":
        raise InputError(
            f"{path} is no table of detections, but may be a corners.vnl of mrcal or mrgingham. Make a "
            "table of it with 'labcal convert', and state `target`, and `cameras` of several."
        )
    # The name of the board is among the columns where it is stated.
    header = _OF_BOARDS if first.rstrip(b"\r\n").endswith(f",{BOARD}".encode()) else HEADER
    pictures = PicturesOfLines(path)
    read = [_columns(part, pictures) for part in table_parts(header, "detections", path)]
    if read:
        picture, index, has_id, figures, flag, board = (
            np.concatenate(column) for column in zip(*read, strict=True)
        )
    else:
        picture, index, has_id, figures, flag, board = _NO_LINES
    number = numbers_of_names(board.tolist(), {})
    keys = np.column_stack([np.where(has_id, picture, -1), index + MOST_INDEX, number])
    refuse_twice(path, keys, "dot of a picture")
    return (
        pictures.column("view", picture),
        pictures.column("camera", picture),
        pictures.column("image", picture),
        pictures.sizes(picture),
        index,
        has_id,
        figures[:, :2],
        figures[:, [2, 3, 3, 4]].reshape(-1, 2, 2),
        flag,
        board,
    )


_NO_LINES = (
    np.empty(0, dtype=np.int64),
    np.empty((0, 2), dtype=np.int64),
    np.empty(0, dtype=bool),
    np.empty((0, 5)),
    np.empty(0, dtype=np.str_),
    np.empty(0, dtype=np.str_),
)


def _columns(part: TableLines, pictures: PicturesOfLines) -> tuple[np.ndarray, ...]:
    """Return picture, (col, row), whether there is one, figures, flag and board; raise at a damaged line."""
    picture = pictures.numbers(part)
    size = pictures.sizes(picture)
    index = part.whole(("col", "row"), empty="0")
    has_id = np.array([line[5] != "" and line[6] != "" for line in part.lines])
    figures = part.figures(HEADER[7:12])
    flag = np.array(part.column("flag"), dtype=object)  # of any length until it is known
    ok, missing = flag == DotFlag.OK.value, np.isnan(figures).all(axis=1)
    part.require(np.isin(flag, list(_FLAGS)), f"its flag should be one of {', '.join(sorted(_FLAGS))}")
    part.require((np.abs(index) <= MOST_INDEX).all(axis=1), f"col and row are at most {MOST_INDEX}")
    part.require(missing | near_picture(size, figures[:, :2]), "it is far outside of its picture")
    part.require(missing | covaries_soundly(size, figures[:, 2:]), "its covariance is none")
    part.require(~ok | (has_id & ~missing), "what is flagged 'ok' has a column, a row and a position")
    board = np.full(len(part), "", dtype=object)
    if BOARD in part.header:
        board = np.array(part.column(BOARD), dtype=object)
        named = np.array(
            [is_name(name) if name else not known for name, known in zip(board, has_id, strict=True)]
        )
        part.require(
            named, "its board should be a name of letters, digits and hyphens, as of each dot with an id"
        )
    part.refuse()
    return picture, index, has_id, figures, flag.astype(np.str_), board.astype(np.str_)


_FLAGS = frozenset(flag.value for flag in DotFlag)
