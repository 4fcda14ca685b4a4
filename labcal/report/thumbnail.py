"""Pictures of any kind made small enough to look at."""

import cv2
import numpy as np
from jaxtyping import Shaped, UInt8

_DISPLAY_GAMMA = 2.2


def thumbnail(picture: Shaped[np.ndarray, "*shape"], width: int, height: int) -> UInt8[np.ndarray, "h w 3"]:
    """Return a picture scaled down to fit into a box, never up, in 8-bit red, green, blue.

    Parameters
    ----------
    picture : ndarray, shape (h, w) or (h, w, 3)
        uint8, uint16, or linear float with white at 1, which is given the gamma of a display.
    width, height : int
        The box, px.
    """
    scale = min(width / picture.shape[1], height / picture.shape[0], 1.0)
    size = (max(1, round(picture.shape[1] * scale)), max(1, round(picture.shape[0] * scale)))
    small: np.ndarray = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
    if picture.dtype == np.uint16:
        small = small / 257.0
    elif picture.dtype != np.uint8:
        small = 255.0 * np.clip(np.nan_to_num(small), 0.0, 1.0) ** (1 / _DISPLAY_GAMMA)
    eight_bit: np.ndarray = np.rint(small).astype(np.uint8)
    if eight_bit.ndim == 2:  # noqa: PLR2004 - grey
        eight_bit = np.repeat(eight_bit[..., None], 3, axis=-1)
    return eight_bit
