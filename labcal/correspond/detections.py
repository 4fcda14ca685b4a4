"""``detections.csv``: the dots of many pictures in one table."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from math import isnan
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float64, Int64

from labcal.bounds import LONGEST_SIDE_PX, MOST_INDEX
from labcal.correspond.sense import measured_soundly, refuse_contradictions
from labcal.correspond.sources import Source
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag
from labcal.errors import InputError
from labcal.run.file_kinds import beginning_with
from labcal.run.names import is_name
from labcal.run.tables import damaged_line, read_table, table_text
from labcal.wording import has_control

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
                "Tell cameras apart with --cameras, or leave the odd pictures out."
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
    lines = read_table(HEADER, "detections", path)
    flags = {flag.value for flag in DotFlag}
    figures = np.full((len(lines), 5), np.nan)
    whole = np.zeros((len(lines), 4), dtype=np.int64)
    has_id = np.zeros(len(lines), dtype=bool)
    for i, line in enumerate(lines):
        try:
            view, camera, image, width, height, col, row, x, y, xx, xy, yy, flag = line
            has_id[i] = col != "" and row != ""
            size, index = (int(width), int(height)), (int(col or 0), int(row or 0))
            values = [float(v) for v in (x, y, xx, xy, yy)]
            sound = (
                flag in flags
                and is_name(camera)
                and not (has_control(view) or has_control(image))
                and 1 <= min(size) <= max(size) <= LONGEST_SIDE_PX
                and max(map(abs, index)) <= MOST_INDEX
            )
            whole[i], figures[i] = (*size, *index), values
        except (ValueError, OverflowError):
            sound = False
        measured = sound and measured_soundly(size, values)
        missing = sound and all(map(isnan, values))
        if (
            not sound
            or not (measured or missing)
            or (flag == DotFlag.OK.value and not (measured and has_id[i]))
        ):
            raise damaged_line(path, i, line)
    refuse_contradictions(path, lines, whole, has_id)
    names = np.array([line[:3] for line in lines], dtype=np.str_).reshape(-1, 3)
    return Detections(
        view=names[:, 0],
        camera=names[:, 1],
        image=names[:, 2],
        size=whole[:, :2],
        index=whole[:, 2:],
        has_id=has_id,
        position=figures[:, :2],
        covariance=figures[:, [2, 3, 3, 4]].reshape(-1, 2, 2),
        flag=np.array([line[-1] for line in lines], dtype=np.str_),
    )
