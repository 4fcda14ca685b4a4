"""Places on a print that are seen around a corner, in compiled code."""

from math import hypot, sqrt
from typing import NamedTuple

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.corners.printed_profile import MOST_OBLIQUE, Axis

_WIDER = 1.02
"""Blurs between the places where the largest ones are looked for, over these."""
_NEAREST = 0.1
"""Least depth there over that of the corner."""


class LocalMap(NamedTuple):
    """Map from offsets (px) from a corner to places on the print, in squares.

    ``at + M r / (1 + h r) + (q0 x^2 / 2 + q1 x y + q2 y^2 / 2)`` along each axis, and of third order
    ``c0 x^3 / 6 + c1 x^2 y / 2 + c2 x y^2 / 2 + c3 y^3 / 6``.
    """

    at: np.ndarray
    """(2,), of the corner."""
    linear: np.ndarray
    """(2, 2)."""
    square: np.ndarray
    """(2, 3)."""
    perspective: np.ndarray
    """(2,), h; known."""
    cube: np.ndarray
    """(2, 4); known."""


@compiled
def most_correlated(offset: np.ndarray, around: LocalMap) -> float:
    """Return the largest correlation of the blurs along both axes, about, at pixels (2, n) of a window."""
    M, h = around.linear, around.perspective
    x, y = np.abs(offset[0]).max(), np.abs(offset[1]).max()
    most = 0.0
    for across in (-1.0, 0.0, 1.0):
        for down in (-1.0, 0.0, 1.0):
            # Half way to the corners of the rectangle, which is wider than the window.
            along, up = 0.5 * across * x, 0.5 * down * y
            away = 1.0 / max(1.0 + h[0] * along + h[1] * up, 0.1)
            plain = M @ np.array([along, up]) * away
            px, py = M[0, 0] - plain[0] * h[0], M[0, 1] - plain[0] * h[1]
            qx, qy = M[1, 0] - plain[1] * h[0], M[1, 1] - plain[1] * h[1]
            most = max(most, abs(px * qx + py * qy) / (hypot(px, py) * hypot(qx, qy)))
    return most


class SeenPlace(NamedTuple):
    """A pixel's place on the print, with the slopes of the map there."""

    first: Axis
    second: Axis
    slopes: tuple[float, float, float, float]
    """Of both places by x and y, 1/px."""
    moved: tuple[float, float]
    """Of both places by the slope of the light, over the blurs in px."""


@compiled
def seen_place(
    state: np.ndarray, around: LocalMap, offset: tuple[float, float], unlit: tuple[float, float]
) -> SeenPlace:
    """Return the place that is seen at an offset from the corner, px; that in even light is known."""
    (x, y), (place_x, place_y) = offset, unlit
    M, Q, h = around.linear, around.square, around.perspective
    gx, gy = state[8], state[9]
    away = 1.0 / (1.0 + h[0] * x + h[1] * y)
    plain_x, plain_y = (M[0, 0] * x + M[0, 1] * y) * away, (M[1, 0] * x + M[1, 1] * y) * away
    px = (M[0, 0] - plain_x * h[0]) * away + Q[0, 0] * x + Q[0, 1] * y
    py = (M[0, 1] - plain_x * h[1]) * away + Q[0, 1] * x + Q[0, 2] * y
    qx = (M[1, 0] - plain_y * h[0]) * away + Q[1, 0] * x + Q[1, 1] * y
    qy = (M[1, 1] - plain_y * h[1]) * away + Q[1, 1] * x + Q[1, 2] * y
    c = around.cube
    by_x, by_xy, by_y = 0.5 * x * x, x * y, 0.5 * y * y
    px += c[0, 0] * by_x + c[0, 1] * by_xy + c[0, 2] * by_y
    py += c[0, 1] * by_x + c[0, 2] * by_xy + c[0, 3] * by_y
    qx += c[1, 0] * by_x + c[1, 1] * by_xy + c[1, 2] * by_y
    qy += c[1, 1] * by_x + c[1, 2] * by_xy + c[1, 3] * by_y
    # Light falls on the print before the lens blurs it: by Stein's lemma its slope moves all edges.
    moved0, moved1 = state[4] * (px * gx + py * gy), state[5] * (qx * gx + qy * gy)
    first2, second2 = px * px + py * py, qx * qx + qy * qy
    # Half the second derivative along the normal, over the squared slope.
    across_x = 0.5 * (Q[0, 0] * px * px + Q[0, 2] * py * py) + Q[0, 1] * px * py
    across_y = 0.5 * (Q[1, 0] * qx * qx + Q[1, 2] * qy * qy) + Q[1, 1] * qx * qy
    first_bend = (across_x / first2 - away * (h[0] * px + h[1] * py)) / first2
    second_bend = (across_y / second2 - away * (h[0] * qx + h[1] * qy)) / second2
    return SeenPlace(
        Axis(place_x + state[4] * moved0, state[4] * sqrt(first2), first_bend),
        Axis(place_y + state[5] * moved1, state[5] * sqrt(second2), second_bend),
        (px, py, qx, qy),
        (moved0, moved1),
    )


@compiled
def blend_at(slopes: tuple[float, float, float, float]) -> tuple[float, float, float]:
    """Return shares of the blurs along a node's diagonal, with a sign for the second, and along the axes."""
    px, py, qx, qy = slopes
    correlation = (px * qx + py * qy) / (hypot(px, py) * hypot(qx, qy))
    size = min(abs(correlation), MOST_OBLIQUE)
    along = sqrt(size)
    return along, along if correlation > 0.0 else -along, sqrt(1.0 - size)


@compiled
def unlit_place(around: LocalMap, x: float, y: float) -> tuple[float, float]:
    """Return the place that is seen at an offset from the corner, px, in even light; squares."""
    M, Q, h, c = around.linear, around.square, around.perspective, around.cube
    away = 1.0 / (1.0 + h[0] * x + h[1] * y)
    by_x, by_xy, by_y = 0.5 * x * x, x * y, 0.5 * y * y
    place_x = around.at[0] + (M[0, 0] * x + M[0, 1] * y) * away
    place_y = around.at[1] + (M[1, 0] * x + M[1, 1] * y) * away
    place_x += Q[0, 0] * by_x + Q[0, 1] * by_xy + Q[0, 2] * by_y
    place_y += Q[1, 0] * by_x + Q[1, 1] * by_xy + Q[1, 2] * by_y
    place_x += ((c[0, 0] * x + 3.0 * c[0, 1] * y) * by_x + (3.0 * c[0, 2] * x + c[0, 3] * y) * by_y) / 3.0
    place_y += ((c[1, 0] * x + 3.0 * c[1, 1] * y) * by_x + (3.0 * c[1, 2] * x + c[1, 3] * y) * by_y) / 3.0
    return place_x, place_y


@compiled
def widest_blurs(state: np.ndarray, offset: np.ndarray, around: LocalMap) -> tuple[float, float]:
    """Return the largest blurs along both axes, about, at pixels (2, n), with what light moves; squares."""
    x, y = np.abs(offset[0]).max(), np.abs(offset[1]).max()
    most_x = most_y = 0.0
    for across in (-1.0, 0.0, 1.0):
        for down in (-1.0, 0.0, 1.0):
            along, up = across * x, down * y
            if 1.0 + around.perspective[0] * along + around.perspective[1] * up <= _NEAREST:
                return np.inf, np.inf
            seen = seen_place(state, around, (along, up), unlit_place(around, along, up))
            moved_x, moved_y = state[4] * abs(seen.moved[0]), state[5] * abs(seen.moved[1])
            most_x, most_y = max(most_x, seen.first.blur + moved_x), max(most_y, seen.second.blur + moved_y)
    return _WIDER * most_x, _WIDER * most_y
