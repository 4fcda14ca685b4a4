"""Pixels around a corner at which a picture is the print, and nothing in front of it; in compiled code."""

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.medians import DEVIATIONS_A_MAD

_BESIDE = 2
"""Pixels to either side whose residuals are looked at together."""
_BEYOND = 3.0
"""Their mean square over that of the noise: of 25 normal residuals it is beyond by a chance of 1e-7."""
_SIDES = 0.5
"""Pattern beyond which pixels are white or black ones; between lie those of edges, where rays have noise."""
_FEWEST = 25
"""Pixels of a kind whose noise is estimated."""
_BLURS = 3.0
"""So far in front of the print a cover's edge is blurred."""


@compiled
def noise_around(residual: np.ndarray, pattern: np.ndarray, least: float) -> np.ndarray:
    """Return the noise of pixels (n,) from the usual residuals of black ones, white ones and those of edges.

    White is noisier than black, in bright light more than in the usual one. What covers less than half of
    the pixels of a kind does not change their median.

    Parameters
    ----------
    residual : ndarray, shape (n,)
    pattern : ndarray, shape (n,)
        The print between -1 (black) and 1.
    least : float
        Standard deviation, below which there is no noise.
    """
    noise = np.full(len(residual), least)
    kind = np.where(pattern > _SIDES, 1, np.where(pattern < -_SIDES, -1, 0))
    for one in (-1, 0, 1):
        which = kind == one
        if which.sum() >= _FEWEST:
            noise[which] = max(least, DEVIATIONS_A_MAD * float(np.median(np.abs(residual[which]))))
    return noise


@compiled
def uncovered(mask: np.ndarray, residual: np.ndarray, noise: np.ndarray, blur: float) -> np.ndarray:
    """Return which of the pixels lie apart from all that have residuals beyond the noise.

    Parameters
    ----------
    mask : ndarray of bool, shape (h, w)
        Which pixels of their rectangle these are.
    residual, noise : ndarray, shape (n,)
        And its standard deviation.
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
                squares[j, i] = (residual[count] / noise[count]) ** 2
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
