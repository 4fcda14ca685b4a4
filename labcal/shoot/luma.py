"""The brightness that lossy pictures store at full resolution; their colours are stored at half of it."""

import numpy as np

from labcal.paths import AnyPath
from labcal.shoot.pictures import is_lossy, through_jpeg
from labcal.shoot.tone_curve import AnyToneCurve, undone

_REC601 = np.array([0.299, 0.587, 0.114], dtype=np.float32)
"""Of red, green and blue (ITU-R BT.601), as JPEG (ITU-T T.871) and WebP store brightness."""


def measured_light(path: AnyPath, picture: np.ndarray, tone_curve: AnyToneCurve) -> np.ndarray:
    """Return the light of a picture that was read from a file, as dots and marks are measured in it.

    Parameters
    ----------
    path, picture
        As of :func:`stored_luma`.
    tone_curve : AnyToneCurve
        To be undone.
    """
    return undone(stored_luma(path, picture), tone_curve)


def stored_luma(path: AnyPath, picture: np.ndarray) -> np.ndarray:
    """Return the brightness of a picture from a lossy file in colour; any other picture as it is.

    JPEG and WebP store brightness for every pixel and colours, most often, for every second one along either
    axis. Any other mean of red, green and blue holds some of the colours, whose fringes at edges, as of a
    colour mosaic, have moved.

    Parameters
    ----------
    path : str or path
        The file that the picture was read from; its ending counts.
    picture : ndarray, shape (height, width) or (height, width, 3)
        Red, green and blue.

    Returns
    -------
    ndarray
        Of the same type, shape (height, width), of a lossy picture in colour.
    """
    return _luma(picture) if is_lossy(path) else picture


def lossy_picture(picture: np.ndarray, quality: int) -> np.ndarray:
    """Return a picture as it is measured when it is read again from a JPEG file.

    Parameters
    ----------
    picture : ndarray of uint8, shape (height, width) or (height, width, 3)
        Red, green and blue.
    quality : int

    Returns
    -------
    ndarray of uint8, shape (height, width)
    """
    return _luma(through_jpeg(picture, quality))


def _luma(picture: np.ndarray) -> np.ndarray:
    """Return the brightness of a picture, in its type; one in grey as it is."""
    if picture.ndim == 2:  # noqa: PLR2004 -- grey
        return picture
    luma: np.ndarray = np.rint(picture.astype(np.float32) @ _REC601)
    return luma.astype(picture.dtype)
