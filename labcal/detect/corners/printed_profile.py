"""Blurred steps of a print along one of its axes, and nodes that join both axes; in compiled code."""

from math import exp, sqrt
from typing import NamedTuple

import numpy as np
from scipy.special import ndtr

from labcal.detect.compiled import compiled

_FAR = 4.5
"""So many blurs from a line nothing is left of its step."""
_STEPS = 256
"""Entries of the table of the normal distribution in a deviation: linear between them to 5e-7."""
_TABLE_AT = np.arange(-int(_FAR * _STEPS) - 1, int(_FAR * _STEPS) + 2) / _STEPS
_BELOW = np.ascontiguousarray(ndtr(_TABLE_AT))
_DENSITY = np.exp(-0.5 * _TABLE_AT**2) / sqrt(2.0 * np.pi)
MOST_OBLIQUE = 0.97
"""Cosine of the angle between the axes' normals."""
_NODES = tuple(np.polynomial.hermite_e.hermegauss(count) for count in (3, 5, 8))
_NODES_3, _NODES_5, _NODES_8 = (np.stack([x, w / w.sum()]) for x, w in _NODES)
_RIGHT = 1e-3
"""Correlation up to which axes are at right angles."""
_UP_TO_3, _UP_TO_5, _UP_TO_8 = 0.15, 0.3, 0.5
"""Correlations up to which so many nodes of Gauss and Hermite leave errors below 1e-3 of half a step."""
_NODE_STEP, _LAST_NODE = 1.3, 3.8
"""Of the trapezoid rule beyond, which converges faster: step over the blur that is left, and its end."""


class Axis(NamedTuple):
    """A place along one axis of a print, with the blur there, both in squares."""

    place: float
    blur: float
    bend: float
    """Change of the distance in the picture over that on the print, from the place to a line, 1/square."""


@compiled
def quadrature(correlation: float) -> np.ndarray:
    """Return nodes and weights (2, k) of a normal distribution that join two axes whose blurs correlate so.

    A blur that is alike in all directions is correlated between oblique axes. It is a blur along each axis
    alone, by the share ``1 - c`` of the variance, after one along a diagonal, of which these are the nodes.
    """
    size = min(abs(correlation), MOST_OBLIQUE)
    if size < _RIGHT:
        single = np.zeros((2, 1))
        single[1, 0] = 1.0
        return single
    if size < _UP_TO_3:
        return _NODES_3.copy()
    if size < _UP_TO_5:
        return _NODES_5.copy()
    if size < _UP_TO_8:
        return _NODES_8.copy()
    step = _NODE_STEP * sqrt(1.0 - size)
    side = int(np.ceil(_LAST_NODE / step))
    rule = np.empty((2, 2 * side + 1))
    for k in range(2 * side + 1):
        rule[0, k] = step * (k - side)
        rule[1, k] = exp(-0.5 * rule[0, k] ** 2)
    rule[1] /= rule[1].sum()
    return rule


@compiled
def near_lines(axis: Axis, lines: np.ndarray, around: int) -> tuple[int, int]:
    """Return the first line that the blur reaches, and the one after the last; both the same if none.

    `around` is a line to begin the search at. Then the place is between the line before and that one.
    """
    reach = _FAR * axis.blur
    first = around
    while first > 0 and lines[first - 1] > axis.place - reach:
        first -= 1
    while first < len(lines) and lines[first] <= axis.place - reach:
        first += 1
    last = first
    while last < len(lines) and lines[last] < axis.place + reach:
        last += 1
    return first, last


@compiled
def seen_lines(
    near_x: tuple[int, int], near_y: tuple[int, int], cells: np.ndarray
) -> tuple[tuple[int, int], tuple[int, int]]:
    """Return the lines along both axes without the outer ones that have the same cells on both sides.

    Nothing changes at those, as of markers within black squares: where all cells are alike none is left, and
    where they change along one axis only, none of the other axis.
    """
    x, x_end, y, y_end = near_x[0], near_x[1], near_y[0], near_y[1]
    while x < x_end and _alike_beside_x(cells, x, (y, y_end)):
        x += 1
    while x < x_end and _alike_beside_x(cells, x_end - 1, (y, y_end)):
        x_end -= 1
    while y < y_end and _alike_beside_y(cells, y, (x, x_end)):
        y += 1
    while y < y_end and _alike_beside_y(cells, y_end - 1, (x, x_end)):
        y_end -= 1
    return (x, x_end), (y, y_end)


@compiled
def _alike_beside_x(cells: np.ndarray, line: int, near: tuple[int, int]) -> bool:
    """Return whether cells on both sides of a line along x are the same, those between near lines of y."""
    for j in range(near[0], near[1] + 1):  # noqa: SIM110 -- Numba has no generators in `all`
        if cells[line, j] != cells[line + 1, j]:
            return False
    return True


@compiled
def _alike_beside_y(cells: np.ndarray, line: int, near: tuple[int, int]) -> bool:
    """Return the same of a line along y. Transposed cells in the other one take a tenth of all time more."""
    for i in range(near[0], near[1] + 1):  # noqa: SIM110 -- the same
        if cells[i, line] != cells[i, line + 1]:
            return False
    return True


@compiled
def write_profile(
    axis: Axis, near: tuple[int, int], lines: np.ndarray, blend: tuple[float, float], out: np.ndarray
) -> None:
    """Write weights of the intervals between lines, derivatives by place and blur, densities, (4, m).

    Interval 0 lies before the first near line, whose density is the first. `blend` holds the shift of a
    node, and the share of the blur
    that is left; the place moves with the shift, in blurs.
    """
    shift, left = blend
    first, last = near
    scale = 1.0 / (axis.blur * left)
    out[0, 0], out[1, 0], out[2, 0] = 1.0, 0.0, 0.0
    for k in range(first, last):
        # A line is straight in the picture: the distance from it, in pixels, is what a blur acts on.
        along = axis.place - lines[k]
        away = along * (1.0 + axis.bend * along) * scale
        z = away + shift / left
        at = (z + _FAR) * _STEPS + 1.0
        below, density = 1.0 if z > 0.0 else 0.0, 0.0
        if 0.0 < at < len(_BELOW) - 1:
            entry = int(at)
            part = at - entry
            below = _BELOW[entry] + part * (_BELOW[entry + 1] - _BELOW[entry])
            density = _DENSITY[entry] + part * (_DENSITY[entry + 1] - _DENSITY[entry])
        m = k - first
        by_place = density * scale * (1.0 + 2.0 * axis.bend * along)
        by_blur = -density * away / axis.blur
        out[0, m] -= below
        out[1, m] -= by_place
        out[2, m] -= by_blur
        out[3, m] = by_place
        out[0, m + 1], out[1, m + 1], out[2, m + 1] = below, by_place, by_blur
