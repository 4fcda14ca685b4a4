"""Light that the white cells of a tag spread to the pixels of its corner's fit, in compiled code."""

from math import erf, sqrt

import numpy as np

from labcal.detect.compiled import compiled

_FAR = 6.0
"""Light of a cell so many blurs away is nothing."""


@compiled
def cell_light(
    offset: np.ndarray,
    tag: tuple[np.ndarray, np.ndarray, np.ndarray],
    blurs: tuple[float, float],
) -> np.ndarray:
    """Return the light of white cells at pixels, shape (n,), from 0 (none) to 1 (amid white).

    A cell's light is the product of its blurred profiles along both edges: exact where the edges are at right
    angles, and near enough for what little of it reaches the border.

    Parameters
    ----------
    offset : ndarray, shape (2, n)
        Of the pixels from the corner, px.
    tag : tuple of ndarray
        Ways to the next corners along both edges, in columns, px, shape (2, 2); that to the opposite corner,
        shape (2,); and which cells are white, along the first edge and the second, shape (cells, cells).
    blurs : (float, float)
        Standard deviations along both edges, in tags.
    """
    edges, opposite, white = tag
    cells = white.shape[0]
    # The perspective map of a square to the tag, Heckbert 1989, section 2.2.3, with the corner as origin.
    x1, y1 = edges[0, 0] - opposite[0], edges[1, 0] - opposite[1]
    x2, y2 = edges[0, 1] - opposite[0], edges[1, 1] - opposite[1]
    sx, sy = opposite[0] - edges[0, 0] - edges[0, 1], opposite[1] - edges[1, 0] - edges[1, 1]
    det = x1 * y2 - x2 * y1
    g, h = (sx * y2 - x2 * sy) / det, (x1 * sy - sx * y1) / det
    first, last = cells, -1
    for i in range(cells):
        for j in range(cells):
            if white[i, j]:
                first, last = min(first, i, j), max(last, i, j)
    light = np.zeros(offset.shape[1])
    along, across = np.zeros(cells), np.zeros(cells)
    for k in range(offset.shape[1]):
        x, y = offset[0, k], offset[1, k]
        m00, m01 = (1.0 + g) * edges[0, 0] - g * x, (1.0 + h) * edges[0, 1] - h * x
        m10, m11 = (1.0 + g) * edges[1, 0] - g * y, (1.0 + h) * edges[1, 1] - h * y
        scale = m00 * m11 - m01 * m10
        a, b = (m11 * x - m01 * y) / scale, (m00 * y - m10 * x) / scale
        if a < first / cells - _FAR * blurs[0] or b < first / cells - _FAR * blurs[1]:
            continue
        for i in range(first, last + 1):
            low, high = (
                (i / cells - a) / (sqrt(2.0) * blurs[0]),
                ((i + 1) / cells - a) / (sqrt(2.0) * blurs[0]),
            )
            along[i] = 0.5 * (erf(high) - erf(low))
            low, high = (
                (i / cells - b) / (sqrt(2.0) * blurs[1]),
                ((i + 1) / cells - b) / (sqrt(2.0) * blurs[1]),
            )
            across[i] = 0.5 * (erf(high) - erf(low))
        for i in range(first, last + 1):
            for j in range(first, last + 1):
                if white[i, j]:
                    light[k] += along[i] * across[j]
    return light
