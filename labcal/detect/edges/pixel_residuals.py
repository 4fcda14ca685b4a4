"""Residuals of a fit's pixels, with their distances from the edge and the centre's gradients, compiled."""

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.edges.edge_model import (
    ALONG,
    CHUNK,
    FAR,
    PLANES,
    RESIDUAL,
    ROWS,
    flattened,
    linearise,
)
from labcal.detect.row_products import copy_columns


@compiled
def pixel_residuals(
    state: np.ndarray, shading: np.ndarray, band: tuple[np.ndarray, int], chunk: np.ndarray
) -> np.ndarray:
    """Return residual, blurs from the edge, change with the distance, and the centre's gradients, (5, n).

    Flat pixels are as far from the edge as any, and change nothing.
    """
    planes = chunk.reshape(PLANES, CHUNK)
    pixels, total = band
    found = np.empty((5, pixels.shape[1]))
    for first in range(0, total, CHUNK):
        count = min(CHUNK, total - first)
        copy_columns(pixels, first, planes, (0, count))
        linearise(state, shading, chunk, count)
        copy_columns(planes[RESIDUAL : ALONG + 1], 0, found, (first, count))
        copy_columns(planes[ROWS : ROWS + 2], 0, found[3:], (first, count))
    b0, b1, b2, d0, d1, d2 = shading[0], shading[1], shading[2], shading[3], shading[4], shading[5]
    for k in range(total, pixels.shape[1]):
        u, v = flattened(state, pixels[0, k], pixels[1, k])
        inside = u * u + v * v < 1.0
        shown = d0 + d1 * u + d2 * v if inside else b0 + b1 * u + b2 * v
        found[0, k], found[1, k] = pixels[2, k] - shown, -FAR if inside else FAR
        found[2, k], found[3, k], found[4, k] = 0.0, 0.0, 0.0
    return found
