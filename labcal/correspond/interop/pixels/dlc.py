"""Tables of DeepLabCut, which Anipose and others write and read, too: CSV with a header of some lines.

``scorer``, (``individuals``,) ``bodyparts``, ``coords``: a column each of x, y and, of predictions,
likelihood for every body part; a line a frame, one file a camera. The first cells of a line are the number
of the frame or the path of the picture, in newer tables of labels in three cells. x and y count from the
centre of the first pixel, as pictures are drawn for labelling; the file does not state it.
"""

from collections.abc import Sequence
from math import isnan
from pathlib import Path

from labcal.correspond.interop.pixels.cells import cells_of, number_in
from labcal.correspond.interop.pixels.exchange import (
    PixelFormat,
    PixelLines,
    PixelOptions,
    ReadPixels,
    camera_of_file,
)
from labcal.errors import InputError
from labcal.shoot.pictures import SUFFIXES
from labcal.wording import counted

LIKELIHOOD = 0.6
"""Least likelihood of a pixel, where none is stated: the value that both programs begin with."""
_WITH_LIKELIHOOD = 3
"""Columns of a body part in a table of predictions; two in one of labels."""
_LEVELS = ("scorer", "individuals", "bodyparts", "coords")


def read_dlc(paths: Sequence[Path], given: PixelOptions) -> ReadPixels:
    """Read tables of DeepLabCut, one a camera; points are body parts, views are frames.

    Raises
    ------
    InputError
        A file is no such table or damaged, or its camera is not known.
    """
    least = LIKELIHOOD if given.likelihood is None else given.likelihood
    lines, unlikely, judged = PixelLines(), 0, False
    for path in paths:
        camera, rest = camera_of_file(path, given.cameras)
        rows = cells_of(path)
        head = _header(rows, path)
        columns = _columns(head, path)
        judged = judged or any(len(column) == _WITH_LIKELIHOOD for column in columns.values())
        first = min(at for column in columns.values() for at in column)
        for number, row in rows[len(head) :]:
            if len(row) != len(head[0]):
                raise InputError(
                    f"Line {number} of {path} is damaged: {counted(len(row), 'cell')}, not {len(head[0])}."
                )
            view = "-".join(filter(None, (rest, _frame("".join(row[first - 1 : first])))))
            for point, column in columns.items():
                x, y, *likelihood = (number_in(row[at], path, number) for at in column)
                if isnan(x) != isnan(y):
                    raise InputError(f"Line {number} of {path} is damaged: one of x and y is missing.")
                if isnan(x):  # not labelled
                    continue
                if likelihood and likelihood[0] > 1.0:
                    raise InputError(
                        f"Line {number} of {path} is damaged: the likelihood {likelihood[0]:g} is above 1."
                    )
                if likelihood and not likelihood[0] >= least:
                    unlikely += 1
                    continue
                lines.add((view, camera, point), x, y)
    notes = ["x and y were taken to count from the centre of the first pixel, as DeepLabCut's labels do"]
    if judged:
        notes.append(
            f"{counted(unlikely, 'pixel')} with a likelihood below {least:g} left out: `likelihood` names "
            "another limit"
        )
    return ReadPixels(lines.table(), tuple(notes))


def _frame(cell: str) -> str:
    """Return the frame that a line is of: its number, or the name of its picture without the ending."""
    path = Path(cell)
    return path.stem if path.suffix.lower() in SUFFIXES else path.name or cell


def _header(rows: list[tuple[int, list[str]]], path: Path) -> list[list[str]]:
    """Return the lines of the header."""
    head = []
    for _, row in rows[: len(_LEVELS)]:
        if not row or row[0] not in _LEVELS:
            break
        head.append(row)
    levels = [row[0] for row in head]
    if (
        levels not in (list(_LEVELS), [one for one in _LEVELS if one != "individuals"])
        or len({len(row) for row in head}) != 1
    ):
        raise InputError(
            f"{path} is no table of DeepLabCut: its first lines should begin with scorer, bodyparts, coords "
            "(with individuals before bodyparts where there are several)."
        )
    return head


def _columns(head: list[list[str]], path: Path) -> dict[str, list[int]]:
    """Return the columns of x, y and, where there is one, likelihood of each point."""
    found: dict[str, dict[str, int]] = {}
    for at in range(1, len(head[0])):
        coordinate = head[-1][at]
        if coordinate not in {"x", "y", "likelihood"}:
            continue  # the folders of a picture
        names = [row[at] for row in head[1:-1]]
        columns = found.setdefault("-".join(filter(None, names)), {})
        if columns.setdefault(coordinate, at) != at:
            raise InputError(f"{path} has two columns {coordinate} of '{'-'.join(names)}'. Keep one of them.")
    for point, columns in found.items():
        if not {"x", "y"} <= columns.keys():
            raise InputError(f"{path} has no columns x and y of '{point}'.")
    if not found:
        raise InputError(f"{path} has no columns of body parts.")
    return {
        point: [columns[name] for name in ("x", "y", "likelihood") if name in columns]
        for point, columns in found.items()
    }


DLC = PixelFormat(
    "dlc",
    "CSV with header lines scorer, bodyparts, coords; one a camera",
    ("cameras", "likelihood"),
    read_dlc,
)
