"""A small picture with its dots and its burnt-out pixels marked."""

import cv2
import numpy as np
from jaxtyping import Shaped, UInt8

from labcal.detect.dots import PictureDots
from labcal.report.thumbnail import thumbnail
from labcal.shoot.quality import saturated

_FOUND = (40, 190, 70)
_BURNT = np.array([255.0, 30.0, 30.0])
_BURNT_SHARE = 0.05  # of the pixels under one of the thumbnail


def marked_thumbnail(
    picture: Shaped[np.ndarray, "*shape"], dots: PictureDots, box: tuple[int, int]
) -> UInt8[np.ndarray, "h w 3"]:
    """Return a thumbnail with a green point on every usable dot, and red where the picture is at full scale.

    Parameters
    ----------
    picture : ndarray, shape (h, w) or (h, w, 3)
    dots : PictureDots
        What was found in it.
    box : tuple of int
        Width and height to fit into, px.
    """
    canvas = thumbnail(picture, *box).copy()
    height, width = canvas.shape[:2]
    burnt = cv2.resize(saturated(picture).astype(np.float32), (width, height), interpolation=cv2.INTER_AREA)
    red = burnt > _BURNT_SHARE
    canvas[red] = (0.3 * canvas[red] + 0.7 * _BURNT).astype(np.uint8)
    scale = width / picture.shape[1]
    radius = max(1, round(width / 240))
    # Pixel centres are whole numbers, so the frame begins half a pixel before the first one.
    for x, y in (dots.position[dots.ok] + 0.5) * scale - 0.5:
        cv2.circle(canvas, (round(float(x)), round(float(y))), radius, _FOUND, cv2.FILLED, cv2.LINE_AA)
    return canvas
