"""Tables without a fixed form, whose columns the user names: of VIC-3D, DICe, and any program of one's own.

``point=COLUMN,view=COLUMN,sigma=COLUMN,CAMERA=X:Y``: X and Y are a column or a sum of columns, as in
``left=x+u:y+v,right=x+q:y+r`` for VIC-3D, whose u, v and q, r are the displacements from the reference
picture of its first camera to the picture of the first and of the second one. All but a camera may be left
out: points are then called after their lines, and the view after the file. ``camera=X:Y`` stands for the
camera that the name of the file states.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isnan
from pathlib import Path

from labcal.bounds import LEAST_VARIANCE_PX2, LONGEST_SIDE_PX
from labcal.correspond.interop.pixels.cells import cells_of, number_in
from labcal.correspond.interop.pixels.exchange import (
    PixelFormat,
    PixelLines,
    PixelOptions,
    ReadPixels,
    camera_of_file,
)
from labcal.errors import InputError, UnknownNameError
from labcal.run.names import is_name
from labcal.wording import clipped, counted, printable

_THIS = "camera"
"""In place of a camera's name: the camera that the file's name states."""


@dataclass(frozen=True)
class ColumnChoice:
    """Columns that hold the pixels of a table."""

    cameras: dict[str, tuple[tuple[str, ...], tuple[str, ...]]]
    """By camera: the columns whose sums are x and y."""
    point: str | None = None
    view: str | None = None
    sigma: str | None = None
    """Column of the standard deviation along each axis, px; a pixel where it is negative was not found."""

    @classmethod
    def of(cls, words: str | None) -> "ColumnChoice":
        """Return the columns that words name.

        Raises
        ------
        InputError
            They are none, or not of that form.
        """
        cameras: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {}
        others: dict[str, str] = {}
        for part in (words or "").split(","):
            name, _, value = (piece.strip() for piece in part.partition("="))
            x, colon, y = value.partition(":")
            if name in {"point", "view", "sigma"} and value and name not in others:
                others[name] = value
            elif is_name(name) and x and colon and y and name not in cameras:
                cameras[name] = (_sum(x), _sum(y))
            else:
                raise InputError(
                    "`columns` names the columns of a table, as in 'point=id,left=x+u:y+v,right=x+q:y+r' "
                    f"(X:Y for each camera, + adds columns), but got '{clipped(printable(words or ''))}'."
                )
        if not cameras:
            raise InputError("`columns` names no camera. Add one, as in 'left=x:y'.")
        return cls(cameras, **others)


def _sum(text: str) -> tuple[str, ...]:
    return tuple(piece.strip() for piece in text.split("+"))


def read_columns(paths: Sequence[Path], given: PixelOptions) -> ReadPixels:
    """Read tables by the columns that the user names; a camera named ``camera`` is that of the file's name.

    Raises
    ------
    InputError
        No columns are named, a table does not have them, is damaged, or its camera is not known.
    """
    return read_chosen(paths, ColumnChoice.of(given.columns), given)


def read_chosen(paths: Sequence[Path], chosen: ColumnChoice, given: PixelOptions) -> ReadPixels:
    """Read tables by their columns; as :func:`read_columns`."""
    lines, lost = PixelLines(), 0
    for path in paths:
        camera, view = ("", path.stem)
        if _THIS in chosen.cameras:
            camera, rest = camera_of_file(path, given.cameras)
            view = rest or "view"
        (_, header), *rows = cells_of(path)
        place = _Places(header, path)
        for at, (number, row) in enumerate(rows):
            if len(row) != len(header):
                raise InputError(
                    f"Line {number} of {path} is damaged: {counted(len(row), 'cell')}, not {len(header)}."
                )
            point = str(at) if chosen.point is None else row[place.of(chosen.point)]
            of_view = view if chosen.view is None else row[place.of(chosen.view)]
            sigma = (
                float("nan") if chosen.sigma is None else number_in(row[place.of(chosen.sigma)], path, number)
            )
            if sigma > LONGEST_SIDE_PX or 0.0 < sigma < LEAST_VARIANCE_PX2**0.5:
                raise InputError(
                    f"Line {number} of {path} is damaged: {sigma:g} px is no standard deviation."
                )
            for name, sums in chosen.cameras.items():
                x, y = (
                    sum(number_in(row[place.of(column)], path, number) for column in columns)
                    for columns in sums
                )
                if isnan(x) or isnan(y) or sigma < 0.0:  # not found there
                    lost += 1
                    continue
                lines.add((of_view, camera if name == _THIS else name, point), x, y, sigma or float("nan"))
    notes = [f"{counted(lost, 'pixel')} that the program did not find left out"] if lost else []
    return ReadPixels(lines.table(), tuple(notes))


class _Places:
    """The places of the columns of a table."""

    def __init__(self, header: list[str], path: Path) -> None:
        self._place = {name: at for at, name in enumerate(header)}
        self._path = path
        if len(self._place) < len(header):
            twice = next(name for name in header if header.count(name) > 1)
            raise InputError(f"{path} has two columns '{clipped(printable(twice))}'. Rename one of them.")

    def of(self, name: str) -> int:
        """Return the place of a column."""
        if name not in self._place:
            raise UnknownNameError(f"column in {self._path}", name, self._place)
        return self._place[name]


COLUMNS = PixelFormat(
    "columns",
    "any delimited table with names of columns, such as VIC-3D's",
    ("columns", "cameras"),
    read_columns,
)
