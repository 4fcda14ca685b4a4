"""A board that is found already, hidden in its picture while others are looked for."""

import cv2
import numpy as np

from labcal.detect.dots import PictureDots
from labcal.detect.grey import GreyPicture
from labcal.geometry.projective_map import robust_homography
from labcal.targets.target import PrintableTarget

_LEAST = 4
_RIM_PX = 7


def without_board(grey: GreyPicture, dots: PictureDots, board: PrintableTarget) -> GreyPicture:
    """Return a picture with the grey value around a board in place of it.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
    dots : PictureDots
        The board's dots in the picture.
    board : PrintableTarget

    Returns
    -------
    ndarray
        `grey` itself where the board is not found.
    """
    ok = dots.ok
    if not dots.indexed or ok.sum() < _LEAST:
        return grey
    H = robust_homography(board.points(dots.index[ok])[:, :2], dots.position[ok])
    if H is None:
        return grey
    x_min, y_min, x_max, y_max = board.extent_mm
    corners = (
        np.array([[x_min, y_min, 1.0], [x_max, y_min, 1.0], [x_max, y_max, 1.0], [x_min, y_max, 1.0]]) @ H.T
    )
    if not (corners[:, 2] > 0.0).all():
        return grey
    inside = np.zeros(grey.shape, dtype=np.uint8)
    most = 4 * max(grey.shape)
    outline = np.clip(np.round(corners[:, :2] / corners[:, 2:]), -most, most).astype(np.int32)
    cv2.fillConvexPoly(inside, outline, 1)
    hidden = cv2.dilate(inside, np.ones((3, 3), dtype=np.uint8))
    around = cv2.dilate(inside, np.ones((_RIM_PX, _RIM_PX), dtype=np.uint8))
    band = grey[(around > 0) & (hidden == 0)]
    return np.where(hidden > 0, np.float32(np.median(band)), grey) if band.size else grey
