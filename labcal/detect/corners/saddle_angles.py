"""Angles of the edges at saddle points, less what blur turns them by."""

from dataclasses import replace
from functools import lru_cache
from math import asin, cos, hypot, pi

import numpy as np
from scipy.special import erf

from labcal.detect.corners.saddles import Saddles
from labcal.detect.settings import DetectSettings

_LEAST_DEG, _STEP_DEG = 25.0, 2.5
"""Angles between edges that are tabulated, from the least one to its supplement."""
_SAMPLES = 241
"""Of half a ring."""
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)


def unturned(saddles: Saddles, settings: DetectSettings) -> Saddles:
    """Return saddle points with the angles that their edges have without blur.

    On a ring within a few blurs of an oblique corner the picture is half black and half white in places that
    are more nearly at right angles than the edges: at 40 degrees by 10. The blur is that of the search and
    the usual one of a picture.

    Parameters
    ----------
    saddles : Saddles
    settings : DetectSettings
        With which they were found.
    """
    if not len(saddles.place):
        return saddles
    blur = hypot(settings.saddle.blur_px, settings.corner.first_blur_px)
    seen, true = _angles(settings.saddle.ring_px / blur)
    between = saddles.edges[:, 1] - saddles.edges[:, 0]
    wider = 0.5 * (np.interp(between, seen, true) - between)
    edges = saddles.edges + np.stack([-wider, wider], axis=1)
    # Angles run from 0 to pi: where one leaves that range, the two change places, and so do the colours.
    below, above = edges[:, 0] < 0.0, edges[:, 1] >= pi
    first = np.where(above, edges[:, 1] - pi, np.where(below, edges[:, 1], edges[:, 0]))
    second = np.where(above, edges[:, 0], np.where(below, edges[:, 0] + pi, edges[:, 1]))
    return replace(
        saddles, edges=np.stack([first, second], axis=1), white_between=saddles.white_between ^ below ^ above
    )


@lru_cache(maxsize=8)
def _angles(radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Return angles between edges as a ring (radius in blurs) shows them, ascending, and without blur."""
    count = round((180.0 - 2.0 * _LEAST_DEG) / _STEP_DEG) + 1
    true = np.radians(np.linspace(_LEAST_DEG, 180.0 - _LEAST_DEG, count))
    seen = np.array([_seen_between(angle, radius) for angle in true.tolist()])
    known = np.isfinite(seen)
    order = np.argsort(seen[known])
    return seen[known][order], true[known][order]


def _seen_between(angle: float, radius: float) -> float:
    """Return the angle between the edges of a blurred corner on a ring, rad; NaN where it shows no edges.

    The corner is that of :func:`labcal.detect.corners.corner_fit.fit_corner`, by Plackett's identity.
    """
    around = np.linspace(0.5 * angle - 0.5 * pi, 0.5 * angle + 0.5 * pi, _SAMPLES)
    a, b = radius * np.sin(around), radius * np.sin(angle - around)
    half = 0.5 * asin(-cos(angle))
    turn = half * (1.0 + _NODES)
    power = (0.5 * (a * a + b * b)[:, None] - (a * b)[:, None] * np.sin(turn)) / np.cos(turn) ** 2
    value = erf(a / np.sqrt(2.0)) * erf(b / np.sqrt(2.0)) + 2.0 / pi * half * (np.exp(-power) @ _WEIGHTS)
    value = value - 0.5 * (value.min() + value.max())
    at = np.flatnonzero((value[:-1] > 0.0) != (value[1:] > 0.0))
    if len(at) != 2:  # noqa: PLR2004 -- edges
        return float("nan")
    crossing = around[at] + (around[1] - around[0]) * value[at] / (value[at] - value[at + 1])
    return float(crossing[1] - crossing[0])
