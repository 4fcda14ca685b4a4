"""The darkness that blurred dots spread over their neighbours, subtracted before those are fitted again."""

from math import ceil, erfc, floor, sqrt

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.edges.edge_model import STATE

_FAR_BLURS = 4.5
"""Blurs from an outline beyond which its darkness is nothing: 3e-6 of the step."""
_ROOT_HALF = 0.7071067811865476


@compiled
def any_near(table: np.ndarray, ok: np.ndarray, reach: float, blurs: float) -> bool:
    """Tell whether a dot's own surroundings, up to a reach in radii, are narrower than so many blurs.

    They are narrowest along the minor axis of its outline.
    """
    for k in range(len(table)):
        a, b, c = table[k, 2], table[k, 3], table[k, 4]
        steepest = 0.5 * (a + c) + sqrt(0.25 * (a - c) ** 2 + b * b)
        if ok[k] and (reach - 1.0) / steepest < blurs * table[k, 5]:
            return True
    return False


@compiled
def apart(grey: np.ndarray, table: np.ndarray, ok: np.ndarray, hole: np.ndarray) -> np.ndarray:
    """Return a picture in which every pixel shows the darkness of one dot, that which darkens it most.

    A dot darkens as its fit says, ``step Phi(-d / blur)`` at the distance d from its outline. A disc's own
    tail is less by the square root of radius over distance (Marcum's Q function), but fits of the blur and
    the step err the other way: with that root the outermost dots of dense grids have larger errors.

    Parameters
    ----------
    grey : ndarray, float32, shape (h, w)
    table : ndarray, shape (n, COLUMNS)
        States of the fits.
    ok : ndarray of bool, shape (n,)
        Which of them are fits.
    hole : ndarray, shape (n,)
        Radius of a ring's hole over its outer radius; 0 for a full dot.
    """
    total, most = np.zeros_like(grey), np.zeros_like(grey)
    for k in range(len(table)):
        if not ok[k]:
            continue
        x, y, a, b, c, blur = table[k, 0], table[k, 1], table[k, 2], table[k, 3], table[k, 4], table[k, 5]
        step, det = table[k, STATE] - table[k, STATE + 3], abs(a * c - b * b)
        # Half the sides of the box around the ellipse.
        across = sqrt(b * b + c * c) / det + _FAR_BLURS * blur
        down = sqrt(a * a + b * b) / det + _FAR_BLURS * blur
        for j in range(max(ceil(y - down), 0), min(floor(y + down), grey.shape[0] - 1) + 1):
            for i in range(max(ceil(x - across), 0), min(floor(x + across), grey.shape[1] - 1) + 1):
                u, v = a * (i - x) + b * (j - y), b * (i - x) + c * (j - y)
                gx, gy, rho = a * u + b * v, b * u + c * v, sqrt(u * u + v * v) + 1e-12
                sharp = rho / (blur * (sqrt(gx * gx + gy * gy) + 1e-12))
                dark = step * (_disc(rho, 1.0, sharp) - _disc(rho, hole[k], sharp))
                total[j, i] += dark
                most[j, i] = max(most[j, i], dark)
    alone: np.ndarray = grey + (total - most)
    return alone


@compiled
def _disc(rho: float, radius: float, sharp: float) -> float:
    """Return how dark a blurred disc is at a distance from its middle; `sharp` is the inverse of the blur."""
    if radius == 0.0:
        return 0.0
    return 0.5 * erfc(_ROOT_HALF * (rho - radius) * sharp)
