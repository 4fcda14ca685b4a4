"""Checks of lines of detections: near their pictures, each dot once, one picture per view."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float64, Int64

from labcal.arrays import Mask
from labcal.bounds import LEAST_VARIANCE_PX2, LONGEST_SIDE_PX, MARGIN_SIDES, MOST_PICTURES
from labcal.errors import InputError
from labcal.run.names import is_name
from labcal.run.table_columns import TableLines, names_of_lines
from labcal.wording import has_control

PICTURE = ("view", "camera", "image", "width_px", "height_px")
"""The columns that say which picture a line is of."""
_MOST_LETTERS = 4096
"""Of a picture's path, as operating systems have it."""


def near_picture(size: Int64[np.ndarray, "n 2"], position: Float64[np.ndarray, "n 2"]) -> Mask:
    """Return a mask of positions inside or near their pictures, px."""
    margin = MARGIN_SIDES * size
    return np.asarray(((-margin <= position) & (position <= size + margin)).all(axis=1))


def in_picture(size: Int64[np.ndarray, "n 2"], position: Float64[np.ndarray, "n 2"]) -> Mask:
    """Return a mask of positions on the pixels of their pictures, px; the first one spans -0.5 to 0.5."""
    return np.asarray((np.abs(position - (size - 1.0) / 2.0) <= size / 2.0).all(axis=1))


def covaries_soundly(size: Int64[np.ndarray, "n 2"], covariance: Float64[np.ndarray, "n 3"]) -> Mask:
    """Return a mask of covariances that are possible for a position in a picture, or not stated (NaN).

    Parameters
    ----------
    size : ndarray, shape (n, 2)
        Width and height of the picture, px.
    covariance : ndarray, shape (n, 3)
        xx, xy, yy, px squared.

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    xx, xy, yy = covariance.T
    most = (size.astype(np.float64) ** 2).sum(axis=1)
    with np.errstate(invalid="ignore", over="ignore"):
        least, largest = np.minimum(xx, yy), np.maximum(xx, yy)
        stated = (least >= LEAST_VARIANCE_PX2) & (largest <= most) & (xy * xy < xx * yy)
    return np.asarray(stated | np.isnan(covariance).all(axis=1))


class PicturesOfLines:
    """The pictures that lines of a table are of: each checked once, where it first appears."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._number: dict[tuple[str, ...], int] = {}
        self._of: dict[tuple[str, str], int] = {}
        self._sizes: list[tuple[int, int]] = []

    def numbers(self, part: TableLines) -> Int64[np.ndarray, " lines"]:
        """Return the index of the picture of every line; faults are recorded in the part."""
        numbers = np.empty(len(part), dtype=np.int64)
        last, number = None, 0
        for at, line in enumerate(part.lines):
            key = tuple(line[: len(PICTURE)])
            if key != last:
                last, number = key, self._number.get(key, -1)
                if number < 0:
                    number = self._new(key, part, at)
            numbers[at] = number
        return numbers

    def sizes(self, lines: Int64[np.ndarray, " n"]) -> Int64[np.ndarray, "n 2"]:
        """Return width and height of pictures of these numbers, px."""
        known = self._sizes
        return np.array([known[number] for number in lines.tolist()], dtype=np.int64).reshape(-1, 2)

    def column(self, name: str, lines: Int64[np.ndarray, " n"]) -> np.ndarray:
        """Return a column of :data:`PICTURE`, as an array of str; `lines` holds each line's picture."""
        return names_of_lines(self._path, [key[PICTURE.index(name)] for key in self._number], lines)

    def _new(self, key: tuple[str, ...], part: TableLines, at: int) -> int:
        view, camera, image, *sides = key
        size = _size(sides)
        if not is_name(camera):
            part.faults.append((at, "a camera's name has letters, digits and hyphens only"))
        elif has_control(view) or has_control(image):
            part.faults.append((at, "a name in it has control characters"))
        elif len(view) > _MOST_LETTERS or len(image) > _MOST_LETTERS:
            part.faults.append((at, f"a name in it has more than {_MOST_LETTERS} letters"))
        elif size is None:
            part.faults.append((at, f"width and height should be whole numbers from 1 to {LONGEST_SIDE_PX}"))
        elif self._of.setdefault((view, camera), len(self._sizes)) != len(self._sizes):
            part.faults.append((at, "this view of this camera has another picture in a line before"))
        elif len(self._sizes) == MOST_PICTURES:
            raise InputError(
                f"{self._path} has dots of more than {MOST_PICTURES} pictures. Split it by views."
            )
        self._number[key] = len(self._sizes)
        self._sizes.append(size or (1, 1))
        return self._number[key]


def _size(sides: Sequence[str]) -> tuple[int, int] | None:
    """Return a picture's size, px; None where these are no sides of one."""
    try:
        width, height = (int(side) for side in sides)
    except ValueError:
        return None
    return (width, height) if 1 <= min(width, height) <= max(width, height) <= LONGEST_SIDE_PX else None
