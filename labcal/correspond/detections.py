"""``detections.csv``: the dots of many pictures in one table."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float64, Int64

from labcal.bounds import MOST_INDEX
from labcal.correspond.sense import PicturesOfLines, covaries_soundly, near_picture
from labcal.correspond.sources import Source
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag
from labcal.errors import InputError
from labcal.run.file_kinds import beginning_with
from labcal.run.table_columns import TableLines, table_parts
from labcal.run.tables import refuse_twice, table_text

HEADER = (
    "view", "camera", "image", "width_px", "height_px", "col", "row",
    "x_px", "y_px", "var_xx", "var_xy", "var_yy", "flag",
)  # fmt: skip

KIND = beginning_with("a table of detections", f"{','.join(HEADER)}\n".encode())


@dataclass(frozen=True)
class Detections:
    """Dots of many pictures, a line each, in columns of equal length."""

    view: np.ndarray
    """(n,) of str"""
    camera: np.ndarray
    """(n,) of str"""
    image: np.ndarray
    """(n,) of str, the path as given."""
    size: Int64[np.ndarray, "n 2"]
    """Width and height of the picture, px."""
    index: Int64[np.ndarray, "n 2"]
    """(col, row), which mean something only where `has_id`."""
    has_id: Bool[np.ndarray, " n"]
    position: Float64[np.ndarray, "n 2"]
    """Centre of area of the outer outline, px; NaN where not measured."""
    covariance: Float64[np.ndarray, "n 2 2"]
    """Of `position`, px squared."""
    flag: np.ndarray
    """(n,) of str, a :class:`DotFlag`."""

    def __len__(self) -> int:
        return len(self.view)

    @property
    def ok(self) -> Bool[np.ndarray, " n"]:
        """The dots that are measurements of the declared grid."""
        return np.asarray(self.flag == DotFlag.OK.value)

    @cached_property
    def cameras(self) -> tuple[str, ...]:
        """Names of the cameras, in order of appearance."""
        return tuple(dict.fromkeys(self.camera.tolist()))

    @cached_property
    def views(self) -> tuple[str, ...]:
        """Names of the views, in order of appearance."""
        return tuple(dict.fromkeys(self.view.tolist()))

    @cached_property
    def view_number(self) -> Int64[np.ndarray, " n"]:
        """Of each line, the place of its view among :attr:`views`."""
        return _numbers(self.view, self.views)

    @cached_property
    def camera_number(self) -> Int64[np.ndarray, " n"]:
        """Of each line, the place of its camera among :attr:`cameras`."""
        return _numbers(self.camera, self.cameras)

    def by_view(self) -> list["Detections"]:
        """Return the lines of every view, in the order of :attr:`views`."""
        order = np.argsort(self.view_number, kind="stable")
        edges = np.searchsorted(self.view_number[order], np.arange(1, len(self.views)))
        return [self.where(lines) for lines in np.split(order, edges)]

    def where(self, mask: Bool[np.ndarray, " n"] | Int64[np.ndarray, " m"]) -> "Detections":
        """Return the lines where the mask holds, or those of some numbers."""
        return Detections(
            self.view[mask], self.camera[mask], self.image[mask], self.size[mask], self.index[mask],
            self.has_id[mask], self.position[mask], self.covariance[mask], self.flag[mask],
        )  # fmt: skip

    def measured(self) -> "Detections":
        """Return the dots that are measurements of the declared grid.

        Raises
        ------
        InputError
            One has no position, or is listed twice for a picture.
        """
        usable = self.where(self.ok)
        lost = np.flatnonzero(~np.isfinite(usable.position).all(axis=1))
        if len(lost):
            raise InputError(
                f"{usable.words(int(lost[0]))} is flagged 'ok', but has no position. Flag it otherwise."
            )
        dot = np.column_stack([usable.camera_number, usable.view_number, usable.index])
        _, first = np.unique(dot, axis=0, return_index=True)
        if len(first) < len(dot):
            twice = np.setdiff1d(np.arange(len(dot)), first)[0]
            raise InputError(
                f"{usable.words(int(twice))} is listed twice. Keep one line for each dot of a picture."
            )
        return usable

    def words(self, line: int) -> str:
        """Return which dot a line is, for people."""
        col, row = self.index[line]
        return f"Dot ({col}, {row}) in view '{self.view[line]}' of camera '{self.camera[line]}'"

    def picture_size(self, camera: str) -> tuple[int, int]:
        """Return a camera's picture size.

        Raises
        ------
        InputError
            Its pictures differ in size.
        """
        sizes = np.unique(self.size[self.camera == camera], axis=0)
        if len(sizes) != 1:
            listed = ", ".join(f"{w} x {h}" for w, h in sizes)
            raise InputError(
                f"The pictures of camera '{camera}' differ in size ({listed}), but a camera takes one size. "
                "Tell cameras apart with `cameras`, or leave the odd pictures out."
            )
        return (int(sizes[0, 0]), int(sizes[0, 1]))


def _numbers(names: np.ndarray, order: tuple[str, ...]) -> Int64[np.ndarray, " n"]:
    """Return the place of each name in an order."""
    place = {name: number for number, name in enumerate(order)}
    return np.array([place[name] for name in names.tolist()], dtype=np.int64)


def gather(sources: Sequence[Source], pictures: Iterable[PictureDots]) -> Detections:
    """Return one table of what was found in each picture."""
    pairs = list(zip(sources, pictures, strict=True))
    counts = [len(dots.flag) for _, dots in pairs]
    sizes = np.array([dots.size for _, dots in pairs], dtype=np.int64).reshape(-1, 2)
    flags = [flag.value for _, dots in pairs for flag in dots.flag]
    return Detections(
        view=np.repeat(np.array([source.view for source in sources], dtype=np.str_), counts),
        camera=np.repeat(np.array([source.camera for source in sources], dtype=np.str_), counts),
        image=np.repeat(np.array([source.image for source in sources], dtype=np.str_), counts),
        size=np.repeat(sizes, counts, axis=0),
        index=np.concatenate([dots.index for _, dots in pairs]).astype(np.int64),
        has_id=np.concatenate([dots.has_id for _, dots in pairs]),
        position=np.concatenate([dots.position for _, dots in pairs]),
        covariance=np.concatenate([dots.covariance for _, dots in pairs]),
        flag=np.array(flags, dtype=np.str_),
    )


def joined(tables: Sequence[Detections]) -> Detections:
    """Return one table with the lines of several."""
    columns = (column.name for column in fields(Detections))
    return Detections(*(np.concatenate([getattr(table, name) for table in tables]) for name in columns))


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
    return table_text(HEADER, lines)


def read_detections(path: Path) -> Detections:
    """Read ``detections.csv``.

    Raises
    ------
    InputError
        It cannot be read, has other columns, a line in it is damaged, two lines are of the same dot of a
        picture, or a picture has two names or sizes; the line is named.
    """
    pictures = PicturesOfLines(path)
    read = [_columns(part, pictures) for part in table_parts(HEADER, "detections", path)]
    if read:
        picture, index, has_id, figures, flag = (np.concatenate(column) for column in zip(*read, strict=True))
    else:
        picture, index, has_id, figures, flag = _NO_LINES
    keys = np.column_stack([np.where(has_id, picture, -1), index + MOST_INDEX])
    refuse_twice(path, keys, "dot of a picture")
    return Detections(
        view=pictures.column("view", picture),
        camera=pictures.column("camera", picture),
        image=pictures.column("image", picture),
        size=pictures.sizes(picture),
        index=index,
        has_id=has_id,
        position=figures[:, :2],
        covariance=figures[:, [2, 3, 3, 4]].reshape(-1, 2, 2),
        flag=flag,
    )


_NO_LINES = (
    np.empty(0, dtype=np.int64),
    np.empty((0, 2), dtype=np.int64),
    np.empty(0, dtype=bool),
    np.empty((0, 5)),
    np.empty(0, dtype=np.str_),
)


def _columns(
    part: TableLines, pictures: PicturesOfLines
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return picture, (col, row), whether there is one, figures and flag of lines; raise at a damaged one."""
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
    part.refuse()
    return picture, index, has_id, figures, flag.astype(np.str_)


_FLAGS = frozenset(flag.value for flag in DotFlag)
