"""Squares of an AprilGrid in a picture: four saddle points around black, in compiled code."""

from math import atan2, cos, sin

import numpy as np
from scipy.spatial import cKDTree

from labcal.arrays import Pixels
from labcal.detect.compiled import compiled
from labcal.detect.corners.saddles import Saddles

_NEAREST = 96
"""Saddle points among which the next one along an edge is looked for."""
_MOST_TURN = 0.35
"""Most angle between an edge and the way to the next saddle point along it, rad."""
_USUAL_TURN = 0.07
"""Angle at which a point counts as twice as far: a cell's corner may be nearer than the tag's."""
_WAYS = 4


def black_squares(saddles: Saddles) -> Pixels:
    """Return four saddle points around black squares, shape (n, 4, 2), px, anticlockwise as seen, each once.

    Contours, from which OpenCV's detector begins, run together where tags and small squares touch; saddle
    points are where they do.

    Parameters
    ----------
    saddles : Saddles
        Of a picture.
    """
    n = len(saddles.place)
    if n < _WAYS:
        return np.zeros((0, 4, 2))
    ways = np.concatenate([saddles.edges, saddles.edges + np.pi], axis=1)  # ascending angles from x to y
    distance, near = cKDTree(saddles.place).query(saddles.place, min(_NEAREST + 1, n))
    following = _following(saddles.place, ways, distance, near)
    every = np.arange(n)
    ends = np.concatenate([ways[:, 1:], ways[:, :1] + 2.0 * np.pi], axis=1)
    middle = 0.5 * (ways + ends)
    black = np.stack([~saddles.is_white(every, middle[:, way]) for way in range(_WAYS)], axis=1)
    quads = _around_black(following, black)
    _, first = np.unique(np.sort(quads, axis=1), axis=0, return_index=True)
    return np.asarray(saddles.place[quads[np.sort(first)]])


@compiled
def _following(place: np.ndarray, ways: np.ndarray, distance: np.ndarray, near: np.ndarray) -> np.ndarray:
    """Return the next point along each way from each point, shape (n, 4); -1 where there is none."""
    found = np.full(ways.shape, -1)
    for p in range(len(place)):
        for way in range(ways.shape[1]):
            angle, least = ways[p, way], np.inf
            c, s = cos(angle), sin(angle)
            for k in range(1, near.shape[1]):
                dx, dy = place[near[p, k], 0] - place[p, 0], place[near[p, k], 1] - place[p, 1]
                turn = atan2(c * dy - s * dx, c * dx + s * dy)
                if abs(turn) >= _MOST_TURN:
                    continue
                cost = distance[p, k] * (1.0 + (turn / _USUAL_TURN) ** 2)
                if cost < least:
                    least = cost
                    found[p, way] = near[p, k]
    return found


@compiled
def _around_black(following: np.ndarray, black: np.ndarray) -> np.ndarray:
    """Return the numbers of four points around black, shape (m, 4); some more than once.

    From x to y is clockwise as seen, with y down: b, p, a run clockwise, so p, b, c, a does not.
    """
    found = np.empty((4 * 4 * len(following), 4), dtype=np.int64)
    count = 0
    for way in range(4):
        after = (way + 1) % 4
        for p in range(len(following)):
            a, b = following[p, way], following[p, after]
            if not black[p, way] or a < 0 or b < 0 or a == b:
                continue
            for i in range(4):
                c = following[a, i]
                if c < 0 or c in (p, a, b):
                    continue
                if c in (following[b, 0], following[b, 1], following[b, 2], following[b, 3]):
                    found[count, 0], found[count, 1], found[count, 2], found[count, 3] = p, b, c, a
                    count += 1
    return found[:count].copy()


@compiled
def square_levels(grey: np.ndarray, quads: np.ndarray, cells: int) -> np.ndarray:
    """Return the mean levels in the cells of squares (n, 4, 2), shape (n, cells, cells), the top row first.

    NaN where a square has no perspective image. Five interpolated places of a cell count. The map of a square
    to four points is that of Heckbert 1989, section 2.2.3.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
    quads : ndarray, shape (n, 4, 2)
        Corners, px, in the order of (0, 0), (1, 0), (1, 1), (0, 1) of the square.
    cells : int
        Along a side.
    """
    levels = np.full((len(quads), cells, cells), np.nan)
    step = 0.2 / cells
    for n in range(len(quads)):
        x, y = quads[n, :, 0], quads[n, :, 1]
        sx, sy = x[0] - x[1] + x[2] - x[3], y[0] - y[1] + y[2] - y[3]
        x1, y1, x2, y2 = x[1] - x[2], y[1] - y[2], x[3] - x[2], y[3] - y[2]
        det = x1 * y2 - x2 * y1
        if det == 0.0:
            continue
        g, h = (sx * y2 - x2 * sy) / det, (x1 * sy - sx * y1) / det
        if min(1.0 + g, 1.0 + h, 1.0 + g + h) <= 0.0:
            continue
        ax, ay = x[1] - x[0] + g * x[1], y[1] - y[0] + g * y[1]
        bx, by = x[3] - x[0] + h * x[3], y[3] - y[0] + h * y[3]
        for row in range(cells):
            for col in range(cells):
                total = 0.0
                for k in range(5):
                    u, v = (col + 0.5) / cells, 1.0 - (row + 0.5) / cells
                    if k > 0:
                        u += step if k in (1, 3) else -step
                        v += step if k in (1, 2) else -step
                    w = 1.0 + g * u + h * v
                    total += _level(grey, (x[0] + ax * u + bx * v) / w, (y[0] + ay * u + by * v) / w)
                levels[n, row, col] = 0.2 * total
    return levels


@compiled
def _level(grey: np.ndarray, x: float, y: float) -> float:
    """Return the interpolated level of a picture, that of the nearest pixel outside of it."""
    height, width = grey.shape
    x, y = min(max(x, 0.0), width - 1.0), min(max(y, 0.0), height - 1.0)
    i, j = min(int(x), width - 2), min(int(y), height - 2)
    a, b = x - i, y - j
    upper = (1.0 - a) * grey[j, i] + a * grey[j, i + 1]
    lower = (1.0 - a) * grey[j + 1, i] + a * grey[j + 1, i + 1]
    level: float = (1.0 - b) * upper + b * lower
    return level
