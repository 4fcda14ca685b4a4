"""Signed distance from the edge of the print of a target of any kind, from the outlines of its artwork."""

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from jaxtyping import Float32, Float64

from labcal.targets.polygons import print_polygons
from labcal.targets.sheet import Rectangle
from labcal.targets.target import PrintableTarget

MOST_STEPS = 4096
"""Steps of the grid along the longer side of a board, and a few more."""
_MOST_PARTS = 20
"""Parts of the first step from column to column of which the second one may be made."""
_REACH = 2.5
"""Steps from an edge within which distances are computed; farther ones are cut to that."""


@dataclass(frozen=True)
class InkDistance:
    """Distances to the nearest edge of the print on a grid, positive where there is ink.

    Between the points of the grid they are interpolated linearly: the edge is off by the square of a step
    over eight times its radius of curvature, and a sharp corner is cut by less than a step.

    Attributes
    ----------
    origin : tuple of float
        (x, y) of the first point, mm in the target's frame.
    step_mm : float
    distance : ndarray of float32, shape (rows, cols)
        Row 0 is the lowest y; mm.
    """

    origin: tuple[float, float]
    step_mm: float
    distance: Float32[np.ndarray, "rows cols"]


def ink_distance(target: PrintableTarget) -> InkDistance:
    """Return the distances of a target's print.

    The origin of the target's frame and, where places are a whole number of steps apart, every place are
    points of the grid: corners of squares keep their places.

    Parameters
    ----------
    target : PrintableTarget

    Raises
    ------
    InputError
        The kind is a user's, and its outlines are none.
    """
    x_min, y_min, x_max, y_max = target.extent_mm
    pitch = _unit(target)
    step = pitch / np.ceil(pitch * MOST_STEPS / max(x_max - x_min, y_max - y_min))
    return polygon_distance(print_polygons(target), Rectangle(x_min, y_min, x_max, y_max), float(step))


def _unit(target: PrintableTarget) -> float:
    """Return a length of which the steps from column to column are multiples, mm, where there is one."""
    columns = np.array([[0, 0], [1, 0], [min(2, target.cols - 1), 0]])
    first, second, third = target.points(columns)[:, 0].tolist()
    pitch = abs(second - first)
    ratio = Fraction(abs(third - second) / pitch).limit_denominator(_MOST_PARTS)
    return float(pitch / ratio.denominator)


def polygon_distance(
    polygons: list[Float64[np.ndarray, "corners 2"]], within: Rectangle, step: float
) -> InkDistance:
    """Return the distances from the edges of polygons on a grid over a rectangle.

    Parameters
    ----------
    polygons : list of ndarray, shape (corners, 2)
        Closed, mm; ink is where they run around a point, holes run the other way round.
    within : Rectangle
    step : float
        Of the grid, of which the origin of the frame is a point, mm.
    """
    x_min, y_min, x_max, y_max = within.x_min, within.y_min, within.x_max, within.y_max
    low = np.floor(np.array([x_min, y_min]) / step).astype(int) - 2
    high = np.ceil(np.array([x_max, y_max]) / step).astype(int) + 2
    origin = low * step
    cols, rows = (high - low + 1).tolist()
    edges = (_edges(polygons) - origin) / step
    away = _nearest(edges, (rows, cols))
    signed = np.where(_winding(edges, (rows, cols)) != 0, away, -away) * step
    return InkDistance((float(origin[0]), float(origin[1])), step, signed.astype(np.float32))


def _edges(polygons: list[Float64[np.ndarray, "corners 2"]]) -> Float64[np.ndarray, "edges ends xy"]:
    """Return the sides of polygons, shape (edges, 2, 2)."""
    sides = [np.stack([corners[:-1], corners[1:]], axis=1) for corners in polygons]
    return np.concatenate(sides) if sides else np.zeros((0, 2, 2))


def _winding(edges: Float64[np.ndarray, "edges ends xy"], shape: tuple[int, int]) -> np.ndarray:
    """Return how often the outlines run around each point, (rows, cols): not 0 where the print is filled."""
    upward = edges[:, 1, 1] > edges[:, 0, 1]
    low = np.where(upward[:, None], edges[:, 0], edges[:, 1])
    high = np.where(upward[:, None], edges[:, 1], edges[:, 0])
    first, end = np.ceil(low[:, 1]).astype(int), np.ceil(high[:, 1]).astype(int)
    edge, row = _ranges(first, end)
    share = (row - low[edge, 1]) / (high[edge, 1] - low[edge, 1])
    col = np.ceil(low[edge, 0] + share * (high[edge, 0] - low[edge, 0])).astype(int)
    turns = np.zeros((shape[0], shape[1] + 1), dtype=np.int32)
    inside = (row >= 0) & (row < shape[0])
    np.add.at(turns, (row[inside], np.clip(col[inside], 0, shape[1])), np.where(upward[edge[inside]], -1, 1))
    return np.asarray(np.cumsum(turns[:, :-1], axis=1))


def _nearest(edges: Float64[np.ndarray, "edges ends xy"], shape: tuple[int, int]) -> np.ndarray:
    """Return the distance of every point from the nearest side, in steps, at most the reach."""
    found = np.full(shape, _REACH)
    start, way = edges[:, 0], edges[:, 1] - edges[:, 0]
    pieces = np.maximum(1, np.ceil(np.linalg.norm(way, axis=1) / 4.0)).astype(int)
    edge, piece = _ranges(np.zeros_like(pieces), pieces)
    a = start[edge] + way[edge] * (piece / pieces[edge])[:, None]
    d = way[edge] / pieces[edge][:, None]
    length2 = np.maximum((d * d).sum(axis=1), 1e-30)
    corner = np.floor(np.minimum(a, a + d) - _REACH).astype(int)
    width = int(np.ceil(4.0 + 2.0 * _REACH)) + 2
    for row in range(width):
        for col in range(width):
            at = corner + np.array([col, row])
            share = np.clip((((at - a) * d).sum(axis=1)) / length2, 0.0, 1.0)
            away = np.linalg.norm(at - a - share[:, None] * d, axis=1)
            near = (away < _REACH) & (at >= 0).all(axis=1) & (at < [shape[1], shape[0]]).all(axis=1)
            np.minimum.at(found, (at[near, 1], at[near, 0]), away[near])
    return found


def _ranges(first: np.ndarray, end: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return all whole numbers of many ranges, and of which range each is."""
    count = end - first
    of = np.repeat(np.arange(len(first)), count)
    return of, np.arange(len(of)) - np.repeat(np.cumsum(count) - count, count) + np.repeat(first, count)
