"""Rows of a corner's residuals and derivatives from the pattern at its pixels, in compiled code."""

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.corners.corner_chunks import (
    BOARD,
    BY_A,
    BY_B,
    BY_CORRELATION,
    CHUNK,
    FAR_A,
    FAR_B,
    VALUE,
    A,
    B,
    X,
    Y,
)

RESIDUAL, ROWS = 10, 12
"""Number of the row of residuals, below those of derivatives; with one more, of zeros, whole tiles of
products."""
Turned = tuple[float, float, float, float]
"""Cosine and sine of the angles of both edges' normals."""


@compiled
def write_distances(state: np.ndarray, turned: Turned, bend: np.ndarray, own: np.ndarray) -> None:
    """Write how far the pixels of a chunk are from both edges, in blurs, and how far along them, px."""
    c0, s0, c1, s1 = turned
    x0, y0, per0, per1, half0, half1 = (
        state[0],
        state[1],
        1.0 / state[4],
        1.0 / state[5],
        0.5 * bend[0],
        0.5 * bend[1],
    )
    # Light falls on the print before the lens blurs it: by Stein's lemma its slope moves each edge.
    moved0 = state[4] * (c0 * state[8] + s0 * state[9])
    moved1 = state[5] * (c1 * state[8] + s1 * state[9])
    for k in range(CHUNK):
        dx, dy = own[X + k] - x0, own[Y + k] - y0
        far0, far1 = c0 * dy - s0 * dx, c1 * dy - s1 * dx
        own[A + k] = (c0 * dx + s0 * dy - half0 * far0 * far0) * per0 + moved0
        own[B + k] = (c1 * dx + s1 * dy - half1 * far1 * far1) * per1 + moved1
        own[FAR_A + k], own[FAR_B + k] = far0, far1


@compiled
def write_rows(state: np.ndarray, turned: Turned, own: np.ndarray, space: np.ndarray) -> None:
    """Write derivatives by all parameters, and residuals, of a chunk's pixels to its first lines."""
    c0, s0, c1, s1 = turned
    blur0, blur1, mean, step, slope_x, slope_y = state[4], state[5], state[6], state[7], state[8], state[9]
    per0, per1, turn = step / blur0, step / blur1, step * (s0 * c1 - c0 * s1)
    along0, along1 = blur0**2 * (c0 * slope_y - s0 * slope_x), blur1**2 * (c1 * slope_y - s1 * slope_x)
    moved0, moved1 = 2.0 * blur0 * (c0 * slope_x + s0 * slope_y), 2.0 * blur1 * (c1 * slope_x + s1 * slope_y)
    x0, y0, x1, y1 = c0 * blur0**2, s0 * blur0**2, c1 * blur1**2, s1 * blur1**2
    for k in range(CHUNK):
        x, y, board = own[X + k], own[Y + k], space[BOARD + k]
        light = 1.0 + slope_x * x + slope_y * y
        lit, level = light * board, mean + step * board
        by_a, by_b = space[BY_A + k] * (per0 * light), space[BY_B + k] * (per1 * light)
        by_turn = space[BY_CORRELATION + k] * (turn * light)
        space[k], space[CHUNK + k] = -c0 * by_a - c1 * by_b, -s0 * by_a - s1 * by_b
        space[2 * CHUNK + k] = by_a * (own[FAR_A + k] + along0) - by_turn
        space[3 * CHUNK + k] = by_b * (own[FAR_B + k] + along1) + by_turn
        space[4 * CHUNK + k] = by_a * (moved0 - own[A + k])
        space[5 * CHUNK + k] = by_b * (moved1 - own[B + k])
        space[6 * CHUNK + k], space[7 * CHUNK + k] = light, lit
        space[8 * CHUNK + k] = x * level + x0 * by_a + x1 * by_b
        space[9 * CHUNK + k] = y * level + y0 * by_a + y1 * by_b
        space[RESIDUAL * CHUNK + k] = own[VALUE + k] - mean * light - step * lit
