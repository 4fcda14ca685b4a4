"""First parameters of the fit of a corner, in compiled code."""

import numpy as np

from labcal.detect.compiled import compiled

_DARK, _LIGHT = 0.1, 0.9
"""Shares of a window's pixels that are darker than its black and white levels, to begin with."""


@compiled
def write_first_state(
    state: np.ndarray, normals: tuple[float, float], value: np.ndarray, blur: float
) -> None:
    """Write the parameters to begin with: no move, even light, and levels by the ranks of the values.

    `normals` are the directions of those of both edges, rad; `value` (n,) holds the pixels' grey values.
    """
    state[:2] = 0.0
    state[2], state[3] = normals
    state[4], state[5] = blur, blur
    levels = np.sort(value)
    black, level = levels[int(_DARK * (len(levels) - 1))], levels[int(_LIGHT * (len(levels) - 1))]
    state[6], state[7] = 0.5 * (black + level), 0.5 * (level - black)
    state[8:] = 0.0
