"""Whether lines of detections can be measurements: near their pictures, each dot once, one picture a view."""

from collections.abc import Sequence
from math import isnan
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Int64

from labcal.bounds import LEAST_VARIANCE_PX2, MARGIN_SIDES
from labcal.run.tables import damaged_line, refuse_twice


def measured_soundly(size: tuple[int, int], figures: Sequence[float]) -> bool:
    """Tell whether a position is near its picture, and its covariance can be one, or is left open.

    Parameters
    ----------
    size : (int, int)
        Width and height of the picture, px.
    figures : sequence of float
        x, y (px), and xx, xy, yy of the covariance (px squared); NaN where it is left open.
    """
    x, y, xx, xy, yy = figures
    margins = [MARGIN_SIDES * side for side in size]
    if not all(-m <= at <= side + m for at, side, m in zip((x, y), size, margins, strict=True)):
        return False
    if isnan(xx) and isnan(xy) and isnan(yy):
        return True
    most = float(size[0] ** 2 + size[1] ** 2)
    return LEAST_VARIANCE_PX2 <= min(xx, yy) <= max(xx, yy) <= most and xy * xy < xx * yy


def refuse_contradictions(
    path: Path,
    lines: Sequence[Sequence[str]],
    whole: Int64[np.ndarray, "n 4"],
    has_id: Bool[np.ndarray, " n"],
) -> None:
    """Raise where a dot is listed twice for a picture, or a picture has two names or sizes.

    Parameters
    ----------
    path : Path
        Of the table, for messages.
    lines : sequence of sequence of str
        As they stand in it.
    whole : ndarray, shape (n, 4)
        Width and height of each line's picture, and its dot's column and row.
    has_id : ndarray of bool, shape (n,)

    Raises
    ------
    InputError
        The first such line is named.
    """
    pictures: dict[tuple[str, str], tuple[str, int, int]] = {}
    for number, (view, camera, image, *_) in enumerate(lines):
        about = (image, int(whole[number, 0]), int(whole[number, 1]))
        if pictures.setdefault((view, camera), about) != about:
            why = "this view of this camera has another picture in a line before"
            raise damaged_line(path, number, lines[number], why)
    keys: list[object] = list(range(len(lines)))
    for number in np.flatnonzero(has_id).tolist():
        keys[number] = (*lines[number][:2], int(whole[number, 2]), int(whole[number, 3]))
    refuse_twice(path, keys, "dot of a picture")
