"""A picture for the page: small enough to be sent several times a second."""

import cv2
import numpy as np
from jaxtyping import Shaped

WIDEST_PX = 800
QUALITY = 72


def small_jpeg(picture: Shaped[np.ndarray, "*shape"]) -> bytes:
    """Return a picture as JPEG, reduced to :data:`WIDEST_PX` at most.

    Parameters
    ----------
    picture : ndarray, shape (height, width) or (height, width, 3)
        uint8 or uint16, red first.
    """
    step = max(1, -(-picture.shape[1] // (2 * WIDEST_PX)))
    thinned = np.ascontiguousarray(picture[::step, ::step])  # a 20-Mpx picture is not averaged whole
    small = thinned
    if thinned.shape[1] > WIDEST_PX:
        height = max(1, round(thinned.shape[0] * WIDEST_PX / thinned.shape[1]))
        small = cv2.resize(thinned, (WIDEST_PX, height), interpolation=cv2.INTER_AREA)
    if small.dtype == np.uint16:
        small = (small >> 8).astype(np.uint8)
    if small.ndim == 3:  # noqa: PLR2004 -- with colours
        small = cv2.cvtColor(small, cv2.COLOR_RGB2BGR)
    done, data = cv2.imencode(".jpg", small, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    if not done:
        raise RuntimeError("OpenCV could not write a JPEG.")
    return bytes(data)
