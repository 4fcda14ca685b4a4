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
    _write_flat(state, shading, pixels[:, total:], found[:, total:])
    return found


@compiled
def _write_flat(state: np.ndarray, shading: np.ndarray, flat: np.ndarray, found: np.ndarray) -> None:
    """Write the same of flat pixels, (3, n), to columns of their own."""
    cx, cy, a, b, c = state[0], state[1], state[2], state[3], state[4]
    b0, b1, b2, d0, d1, d2 = shading[0], shading[1], shading[2], shading[3], shading[4], shading[5]
    x, y, value, residual, away = flat[0], flat[1], flat[2], found[0], found[1]
    for k in range(len(value)):
        dx, dy = x[k] - cx, y[k] - cy
        u, v = a * dx + b * dy, b * dx + c * dy
        is_dot = u * u + v * v < 1.0
        board, dot = b0 + b1 * u + b2 * v, d0 + d1 * u + d2 * v
        residual[k], away[k] = value[k] - (dot if is_dot else board), -FAR if is_dot else FAR
    for i in range(2, found.shape[0]):
        row = found[i]
        for k in range(len(row)):
            row[k] = 0.0
