"""Rings around saddle points: whether two edges cross there, at what angles, and where it is white."""

from math import cos, floor, pi, sin
from typing import NamedTuple

import numpy as np

from labcal.detect.compiled import compiled

READING = 4
"""Of a ring: angles of the two edges, 1 where it is white between them, else -1; step."""
_HALF = 24
"""Samples along half a ring."""
_COSINE = np.array([cos(pi * i / _HALF) for i in range(2 * _HALF)])
_SINE = np.array([sin(pi * i / _HALF) for i in range(2 * _HALF)])


class RingLimits(NamedTuple):
    """The settings of saddle points that the reading of rings takes."""

    ring_px: float
    max_odd_share: float
    max_uneven_share: float
    min_angle_deg: float


@compiled
def read_rings(smooth: np.ndarray, places: np.ndarray, limits: RingLimits) -> np.ndarray:
    """Return the readings of the rings around places (n, 2), shape (n, READING); NaN where no edges cross.

    A chessboard's corner is the same on opposite sides; an edge is not. Half a ring is then black along one
    arc and white along the other.

    Parameters
    ----------
    smooth : ndarray of float32, shape (h, w)
        The picture, blurred a little.
    places : ndarray, shape (n, 2)
        px.
    limits : RingLimits
    """
    found = np.full((len(places), READING), np.nan)
    height, width = smooth.shape
    value = np.empty(2 * _HALF)
    even, odd = np.empty(_HALF), np.empty(_HALF)
    for k in range(len(places)):
        x, y, r = places[k, 0], places[k, 1], limits.ring_px
        if x < r + 1 or y < r + 1 or x > width - 2 - r or y > height - 2 - r:
            continue
        for i in range(2 * _HALF):
            value[i] = _at(smooth, x + r * _COSINE[i], y + r * _SINE[i])
        for i in range(_HALF):
            even[i] = 0.5 * (value[i] + value[i + _HALF])
            odd[i] = 0.5 * (value[i] - value[i + _HALF])
        _read(even, odd, limits, found[k])
    return found


@compiled
def _at(picture: np.ndarray, x: float, y: float) -> float:
    """Return the linearly interpolated value of a picture, px."""
    i, j = floor(x), floor(y)
    a, b = x - i, y - j
    low = (1.0 - a) * picture[j, i] + a * picture[j, i + 1]
    high = (1.0 - a) * picture[j + 1, i] + a * picture[j + 1, i + 1]
    level: float = (1.0 - b) * low + b * high
    return level


@compiled
def _read(even: np.ndarray, odd: np.ndarray, limits: RingLimits, reading: np.ndarray) -> None:
    """Write the reading of half a ring, if it is one."""
    mean = even.mean()
    between, unlike = ((even - mean) ** 2).sum(), (odd**2).sum()
    if not unlike < limits.max_odd_share * (between + unlike):
        return
    middle = 0.5 * (even.min() + even.max())
    crossings = np.empty(2)
    count = 0
    for i in range(_HALF):
        here, there = even[i] - middle, even[(i + 1) % _HALF] - middle
        if (here > 0.0) != (there > 0.0):
            if count == len(crossings):
                return
            crossings[count] = (i + here / (here - there)) * pi / _HALF
            count += 1
    if count < len(crossings):
        return
    angle = crossings[1] - crossings[0]
    least = limits.min_angle_deg * pi / 180.0
    if angle < least or angle > pi - least:
        return
    light, dark = even[even > middle].mean(), even[even <= middle].mean()
    uneven = 0.0
    for i in range(_HALF):
        level = light if even[i] > middle else dark
        uneven += (even[i] - level) ** 2
    if uneven > limits.max_uneven_share * between:
        return
    inside = int(0.5 * (crossings[0] + crossings[1]) * _HALF / pi)
    reading[0], reading[1] = crossings[0], crossings[1]
    reading[2] = 1.0 if even[inside] > middle else -1.0
    reading[3] = light - dark
