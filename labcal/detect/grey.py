"""Pictures of every common kind to one grey float picture."""

import cv2
import numpy as np
from jaxtyping import Float32, Shaped

from labcal.errors import InputError, InputTypeError

AnyPicture = Shaped[np.ndarray, "*shape"]
"""(h, w), or (h, w, 3 or 4), of uint8, uint16 or float; other kinds are refused with a message."""

_ROWS = 256
"""So many rows, evenly spread, stand for all pixels."""
GreyPicture = Float32[np.ndarray, "h w"]
"""Grey values in the unit of the picture they came from."""


def grey_picture(image: AnyPicture) -> GreyPicture:
    """Return the picture in grey.

    Colours are weighted 1 : 2 : 1, so that red-green-blue and blue-green-red give the same; a fourth
    channel (alpha) is left out.

    Raises
    ------
    InputTypeError
        The values are neither 8 nor 16 bit unsigned nor floats.
    InputError
        The shape is not that of a picture, or values are not finite.
    """
    if image.dtype not in (np.uint8, np.uint16) and not np.issubdtype(image.dtype, np.floating):
        raise InputTypeError(
            f"A picture should hold uint8, uint16 or float values, but holds {image.dtype}. Convert it first."
        )
    colour = image.ndim == 3 and image.shape[2] in (3, 4)  # noqa: PLR2004 - dimensions and channels
    single = image.ndim == 3 and image.shape[2] == 1  # noqa: PLR2004 - the same
    if not (colour or single or image.ndim == 2):  # noqa: PLR2004 - the same
        raise InputError(
            f"A picture should have shape (h, w), (h, w, 3) or (h, w, 4), but has {image.shape}."
        )
    if colour:
        grey = (image[..., 0].astype(np.float32) + image[..., 2]) / 4 + image[..., 1].astype(np.float32) / 2
    else:
        grey = image.reshape(image.shape[:2])
    grey = np.ascontiguousarray(grey, dtype=np.float32)
    if np.issubdtype(image.dtype, np.floating) and not np.isfinite(grey).all():
        raise InputError("The picture holds values that are not finite. Replace NaN and infinity first.")
    return grey


def clipping(grey: GreyPicture, share: float) -> tuple[float, float]:
    """Return the grey values at and beyond which a picture is clipped, infinite where it is not.

    A picture is clipped where more than a share of its pixels have its least or its largest value.
    """
    if grey.size == 0:
        return -np.inf, np.inf
    some = grey[:: 1 + grey.shape[0] // _ROWS]
    few, low, high = share * some.size, some.min(), some.max()
    black, burnt = np.count_nonzero(some == low) > few, np.count_nonzero(some == high) > few
    if not (black or burnt):  # nor are there values beyond them in so many pixels
        return -np.inf, np.inf
    least, largest, _, _ = cv2.minMaxLoc(grey)
    return (least if black and low == least else -np.inf), (largest if burnt and high == largest else np.inf)


def is_flat(grey: GreyPicture) -> bool:
    """Tell whether all pixels are alike."""
    some = grey[:: 1 + grey.shape[0] // _ROWS, :: 1 + grey.shape[1] // _ROWS]  # most pictures differ here
    return all(part.size == 0 or bool(part.min() == part.max()) for part in (some, grey))
