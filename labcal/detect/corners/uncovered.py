"""Pixels around a corner at which a picture is the print, and nothing in front of it; in compiled code."""

import numpy as np

from labcal.detect.compiled import compiled

_BESIDE = 2
"""Pixels to either side whose residuals are looked at together."""
_BEYOND = 3.0
"""Their mean square over that of the noise: of 25 normal residuals it is beyond by a chance of 1e-7."""
_BLURS = 3.0
"""So far in front of the print a cover's edge is blurred."""


@compiled
def uncovered(mask: np.ndarray, residual: np.ndarray, noise: float, blur: float) -> np.ndarray:
    """Return which of the pixels lie apart from all that have residuals beyond the noise.

    Parameters
    ----------
    mask : ndarray of bool, shape (h, w)
        Which pixels of their rectangle these are.
    residual : ndarray, shape (n,)
    noise : float
        Its standard deviation.
    blur : float
        Of edges, px.

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    height, width = mask.shape
    squares = np.zeros((height, width))
    count = 0
    for j in range(height):
        for i in range(width):
            if mask[j, i]:
                squares[j, i] = (residual[count] / noise) ** 2
                count += 1
    is_clear = np.ones((height, width), dtype=np.bool_)
    reach = _BESIDE + int(np.ceil(_BLURS * blur))
    for j in range(height):
        for i in range(width):
            if _is_beyond(mask, squares, j, i):
                is_clear[max(j - reach, 0) : j + reach + 1, max(i - reach, 0) : i + reach + 1] = False
    found = np.empty(count, dtype=np.bool_)
    k = 0
    for j in range(height):
        for i in range(width):
            if mask[j, i]:
                found[k] = is_clear[j, i]
                k += 1
    return found


@compiled
def _is_beyond(mask: np.ndarray, squares: np.ndarray, j: int, i: int) -> bool:
    """Return whether the squares around a pixel, where half of them are known, are beyond those of noise."""
    down = slice(max(j - _BESIDE, 0), j + _BESIDE + 1)
    along = slice(max(i - _BESIDE, 0), i + _BESIDE + 1)
    near = mask[down, along].sum()
    return bool(2 * near > (2 * _BESIDE + 1) ** 2 and squares[down, along].sum() > _BEYOND * near)
