"""Resampling of pictures: each new pixel takes the value at a position in the old picture."""

import cv2
import numpy as np
from jaxtyping import Float32

from labcal.errors import InputError

_TYPES = (np.uint8, np.uint16, np.float32)
_LONGEST = 2**15 - 1
"""OpenCV's bound on the width and height of what it resamples."""
_NOWHERE = -1e6


def resampled(picture: np.ndarray, source: Float32[np.ndarray, "height width 2"]) -> np.ndarray:
    """Return a picture interpolated linearly, with type and colours of the old one; 0 outside of it.

    Of OpenCV's interpolations the linear one is exact in its places; the others round them to 1/32 px.

    Parameters
    ----------
    picture : ndarray, shape (h, w) or (h, w, 3)
        uint8, uint16 or float32.
    source : ndarray of float32, shape (height, width, 2)
        x and y in the old picture of every new pixel, px; NaN for none.

    Raises
    ------
    InputError
        The picture is of another type, or a side of either is too long.
    """
    if picture.dtype not in _TYPES:
        raise InputError(
            f"Pictures of type {picture.dtype} are not resampled. Convert them to 8 or 16 bits, or to "
            f"float32."
        )
    if max(*picture.shape[:2], *source.shape[:2]) > _LONGEST:
        raise InputError(f"A picture with more than {_LONGEST} pixels along a side is not resampled. Cut it.")
    places = np.nan_to_num(source, nan=_NOWHERE, posinf=_NOWHERE, neginf=_NOWHERE)
    x, y = np.ascontiguousarray(places[..., 0]), np.ascontiguousarray(places[..., 1])
    return np.asarray(
        cv2.remap(picture, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=0)
    )
