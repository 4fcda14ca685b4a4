"""Rows of a corner's residuals and derivatives from the pattern at its pixels, in compiled code."""

from math import cos, sin

import numpy as np

from labcal.detect.compiled import compiled


@compiled
def write_levels(
    state: np.ndarray,
    offset: np.ndarray,
    seen: tuple[np.ndarray, np.ndarray],
    rows: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> None:
    """Write residuals, and derivatives by the mean and the half step.

    `seen` holds the pixels' values and the pattern. Loops over few arrays without branches: the processor
    takes several pixels at a time.
    """
    value, board = seen
    residual, light, lit = rows
    mean, step, slope_x, slope_y, x, y = state[6], state[7], state[8], state[9], offset[0], offset[1]
    for k in range(len(value)):
        light[k] = 1.0 + slope_x * x[k] + slope_y * y[k]
    for k in range(len(value)):
        lit[k] = light[k] * board[k]
    for k in range(len(value)):
        residual[k] = value[k] - mean * light[k] - step * lit[k]


@compiled
def write_rows(
    state: np.ndarray,
    pixels: tuple[np.ndarray, np.ndarray],
    slopes: tuple[np.ndarray, np.ndarray, np.ndarray],
    jacobian: np.ndarray,
) -> None:
    """Write the derivatives by the corner, angles, blurs and slope of the light, in loops as above.

    `pixels` holds the offsets and the pattern, `slopes` its derivatives by both distances and the
    correlation; the rows of the angles hold the distances along the edges to begin with, those of the blurs
    the distances from them, and the row of the mean the light.
    """
    (offset, board), (first, second, turn) = pixels, slopes
    c0, s0, c1, s1 = cos(state[2]), sin(state[2]), cos(state[3]), sin(state[3])
    blur0, blur1, mean, step, light, n = state[4], state[5], state[6], state[7], jacobian[6], len(board)
    _scale(first, step / blur0, light)
    _scale(second, step / blur1, light)
    _scale(turn, step * sin(state[2] - state[3]), light)
    for row, slope, turned, sign in (
        (2, first, blur0**2 * (c0 * state[9] - s0 * state[8]), -1.0),
        (3, second, blur1**2 * (c1 * state[9] - s1 * state[8]), 1.0),
    ):
        across = jacobian[row]
        for k in range(n):
            across[k] = slope[k] * (across[k] + turned) + sign * turn[k]
    for row, slope, moved in (
        (4, first, 2.0 * blur0 * (c0 * state[8] + s0 * state[9])),
        (5, second, 2.0 * blur1 * (c1 * state[8] + s1 * state[9])),
    ):
        along = jacobian[row]
        for k in range(n):
            along[k] = slope[k] * (moved - along[k])
    for row, by0, by1 in ((0, -c0, -c1), (1, -s0, -s1)):
        out = jacobian[row]
        for k in range(n):
            out[k] = by0 * first[k] + by1 * second[k]
    for row, by0, by1 in ((8, c0 * blur0**2, c1 * blur1**2), (9, s0 * blur0**2, s1 * blur1**2)):
        out, away = jacobian[row], offset[row - 8]
        for k in range(n):
            out[k] = away[k] * (mean + step * board[k]) + by0 * first[k] + by1 * second[k]


@compiled
def _scale(slope: np.ndarray, factor: float, light: np.ndarray) -> None:
    """Multiply a derivative of the pattern, in place, by the light and a factor."""
    for k in range(len(slope)):
        slope[k] *= factor * light[k]
