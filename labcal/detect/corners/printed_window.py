"""Pixels of the fit of a corner by the print around it, in compiled code."""

from math import hypot

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.corners.printed_place import LocalMap


@compiled
def print_pixels(
    grey: np.ndarray, centre: np.ndarray, around: LocalMap, limits: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the mask, offsets and values of pixels that are nearer to a corner than to the next ones.

    `limits` are the reach along either axis, in squares, and the most distance, px.
    """
    share, reach = limits
    M, Q, h = around.linear, around.square, around.perspective
    det = abs(M[0, 0] * M[1, 1] - M[0, 1] * M[1, 0])
    # By half more than the parallelogram of the linear part, since the map is none.
    across = min(reach, 1.5 * share * (abs(M[1, 1]) + abs(M[0, 1])) / det)
    down = min(reach, 1.5 * share * (abs(M[0, 0]) + abs(M[1, 0])) / det)
    left, top = max(int(np.ceil(centre[0] - across)), 0), max(int(np.ceil(centre[1] - down)), 0)
    right = min(int(np.floor(centre[0] + across)), grey.shape[1] - 1)
    bottom = min(int(np.floor(centre[1] + down)), grey.shape[0] - 1)
    wide, high = max(right - left + 1, 0), max(bottom - top + 1, 0)
    mask = np.zeros((high, wide), dtype=np.bool_)
    offset, value = np.empty((2, high * wide)), np.empty(high * wide)
    n = 0
    for j in range(high):
        for i in range(wide):
            x, y = left + i - centre[0], top + j - centre[1]
            away = 1.0 + h[0] * x + h[1] * y
            if away <= 0.0:
                continue
            a = (
                (M[0, 0] * x + M[0, 1] * y) / away
                + 0.5 * (Q[0, 0] * x * x + Q[0, 2] * y * y)
                + Q[0, 1] * x * y
            )
            b = (
                (M[1, 0] * x + M[1, 1] * y) / away
                + 0.5 * (Q[1, 0] * x * x + Q[1, 2] * y * y)
                + Q[1, 1] * x * y
            )
            if max(abs(a), abs(b)) >= share or hypot(x, y) >= reach:
                continue
            mask[j, i] = True
            offset[0, n], offset[1, n], value[n] = x, y, grey[top + j, left + i]
            n += 1
    return mask, offset[:, :n].copy(), value[:n].copy()
