"""The lines of a ``corners.vnl``, checked one by one."""

import re
from math import isfinite
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from labcal.bounds import MOST_PICTURES
from labcal.errors import InputError
from labcal.run.decimal_words import decimal
from labcal.run.tables import MOST_LINES
from labcal.targets.target import Target

_LINE = re.compile(r"[^\n]+")
_WORD = re.compile(r"[^ \t\r]+")
_COMMENT = "#"
_LONGEST_LINE = 2**14
_MISSING = (0.0, 0.0, 0.0)
_MOST_LEVEL = 30
_MOST_COUNTED = 1000
"""Points of an image that are counted before it is given up, if the target has fewer."""
_LEAST_WEIGHT = 1e-10


def points_by_image(
    text: str, kind: str | None, target: Target, path: Path
) -> dict[str, list[tuple[float, float, float]]]:
    """Return x, y (px) and weight of the points of each image; all 0 where a line says that there is none.

    Parameters
    ----------
    text : str
        The whole file, which may hold millions of lines.
    kind : str or None
        Third column: ``weight``, ``level``, or none.
    target : Target
        For messages.
    path : Path
        For messages.

    Raises
    ------
    InputError
        A line is damaged (it is named), there are no images, too many, or one with too many points.
    """
    if text.count("\n") > MOST_LINES:
        raise InputError(f"{path} has more than {MOST_LINES} lines. Split it by images.")
    images: dict[str, list[tuple[float, float, float]]] = {}
    for found in _LINE.finditer(text):
        image, *fields = _WORD.findall(found[0][:_LONGEST_LINE]) or [_COMMENT]
        if image.startswith(_COMMENT):
            continue
        try:
            points = images.setdefault(image, [])
            points.append(_point(fields, kind))
        except ValueError as error:
            number = text.count("\n", 0, found.start()) + 1
            raise InputError(
                f"Line {number} of {path} is damaged: '{' '.join(fields):.60}' should be x, y and a "
                f"{kind or 'weight'}."
            ) from error
        if len(points) > max(target.count, _MOST_COUNTED):
            raise _other_count(image, f"more than {len(points) - 1}", target, path)
        if len(images) > MOST_PICTURES:
            raise InputError(f"{path} lists more than {MOST_PICTURES} images. Split it.")
    if not images:
        raise InputError(f"{path} lists no image.")
    return images


def whole_grid(
    image: str, points: Float64[np.ndarray, "n 3"], target: Target, path: Path
) -> Float64[np.ndarray, "count 3"]:
    """Return the points of a whole grid; all are missing where the image has a single line that says so.

    Raises
    ------
    InputError
        There are fewer or more points than the target has.
    """
    if len(points) == target.count:
        return points
    if len(points) == 1 and points[0, 2] == 0.0:
        return np.zeros((target.count, 3))
    raise _other_count(image, str(len(points)), target, path)


def _other_count(image: str, points: str, target: Target, path: Path) -> InputError:
    """Return the error for an image whose points cannot be those of the target."""
    side = round(float(points) ** 0.5) if points.isdigit() else 0
    corners = f"cols: {side}, rows: {side}" if str(side * side) == points else "cols: N, rows: N"
    return InputError(
        f"{path}: {image:.60} has {points} points, but '{target.name}' has {target.cols} x "
        f"{target.rows}. Name the target that the pictures show. mrgingham and mrcal take chessboards, "
        f"which a file such as board.yaml describes: kind: chessboard, name: board, {corners} (corners), "
        "square_mm: LENGTH, each in a line."
    )


def positive_sigma(word: str, path: Path) -> float:
    """Return a standard deviation, px.

    Raises
    ------
    InputError
        It is no positive number of a sane size.
    """
    try:
        value = decimal(word)
    except ValueError:
        value = np.nan
    if not (np.isfinite(value) and _LEAST_WEIGHT <= value <= 1.0 / _LEAST_WEIGHT):
        raise InputError(f"{path}: the standard deviation '{word:.40}' should be a positive number.")
    return value


def _weighs(weight: float) -> bool:
    """Tell whether a weight can be one; none above 0 is that of a missing point."""
    return weight <= 0.0 or _LEAST_WEIGHT <= weight <= 1.0 / _LEAST_WEIGHT


def _point(fields: list[str], kind: str | None) -> tuple[float, float, float]:
    """Return x, y and weight of a line; all 0 where it says that there is no point.

    Raises
    ------
    ValueError
        It is no such line.
    """
    if len(fields) not in {2, 3} or (len(fields) == 2 and kind is not None):  # noqa: PLR2004 -- x y weight
        raise ValueError(fields)
    if "-" in fields:
        return _MISSING
    x, y, last = (*(decimal(field) for field in fields), 1.0)[:3]
    if not all(map(isfinite, (x, y, last))) or (kind == "level" and last > _MOST_LEVEL) or not _weighs(last):
        raise ValueError(fields)
    if kind == "level":
        last = 2.0**-last if last >= 0.0 else 0.0
    # mrcal takes a negative pixel or weight for a missing point.
    return (x, y, last) if min(x, y) >= 0.0 and last > 0.0 else _MISSING
