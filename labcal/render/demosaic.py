"""Colour from a Bayer mosaic with rows RG, GB: the linear 5 x 5 filters of Malvar, He and Cutler (2004)."""

import cv2
import numpy as np

# Malvar, He, Cutler, "High-quality linear interpolation for demosaicing of Bayer-patterned color images",
# ICASSP 2004, figure 2, times 16; each sums to 16.
_GREEN = [[0, 0, -2, 0, 0], [0, 0, 4, 0, 0], [-2, 4, 8, 4, -2], [0, 0, 4, 0, 0], [0, 0, -2, 0, 0]]
_ROW = [[0, 0, 1, 0, 0], [0, -2, 0, -2, 0], [-2, 8, 10, 8, -2], [0, -2, 0, -2, 0], [0, 0, 1, 0, 0]]
_DIAGONAL = [[0, 0, -3, 0, 0], [0, 4, 0, 4, 0], [-3, 0, 12, 0, -3], [0, 4, 0, 4, 0], [0, 0, -3, 0, 0]]

GREEN = np.array(_GREEN, np.float32) / np.float32(16)
"""Green at a red or blue pixel."""
ALONG_ROW = np.array(_ROW, np.float32) / np.float32(16)
"""Red or blue at a green pixel with neighbours of that colour in its row."""
ALONG_COLUMN = np.ascontiguousarray(ALONG_ROW.T)
"""The same with such neighbours in its column."""
DIAGONAL = np.array(_DIAGONAL, np.float32) / np.float32(16)
"""Red at a blue pixel, or blue at a red one."""
HALO = 2
"""Rows above and below that the colours of a row depend on."""


def mosaic(light: np.ndarray) -> np.ndarray:
    """Return the light that a sensor behind a Bayer mosaic of rows RG, GB receives.

    Parameters
    ----------
    light : ndarray, shape (height, width, 3)
        Red, green, blue.

    Returns
    -------
    ndarray, shape (height, width)
    """
    behind = light[..., 1].copy()
    behind[0::2, 0::2] = light[0::2, 0::2, 0]
    behind[1::2, 1::2] = light[1::2, 1::2, 2]
    return behind


def demosaic(behind: np.ndarray) -> np.ndarray:
    """Return red, green and blue at every pixel of a mosaic of rows RG, GB.

    Parameters
    ----------
    behind : ndarray, shape (height, width)
        White-balanced, so that grey things read the same in all three colours.

    Returns
    -------
    ndarray, shape (height, width, 3)
        float32; may lie slightly outside the range of the reading.
    """
    reading = behind.astype(np.float32)
    green, along_row, along_column, diagonal = (
        cv2.filter2D(reading, cv2.CV_32F, kernel, borderType=cv2.BORDER_REFLECT_101)
        for kernel in (GREEN, ALONG_ROW, ALONG_COLUMN, DIAGONAL)
    )
    picture = np.stack([reading, reading, reading], axis=-1)
    red, blue = picture[..., 0], picture[..., 2]
    for first in (0, 1):  # red pixels lie at even rows and columns, blue ones at odd
        here = (slice(first, None, 2), slice(first, None, 2))
        picture[(*here, 1)] = green[here]
        (blue if first == 0 else red)[here] = diagonal[here]
    for row, own, other in ((0, red, blue), (1, blue, red)):  # the green pixels of rows RG, then of rows GB
        here = (slice(row, None, 2), slice(1 - row, None, 2))
        own[here] = along_row[here]
        other[here] = along_column[here]
    return picture
