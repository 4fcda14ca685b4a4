"""Corners of a chessboard as OpenCV finds them, each of its ways."""

import cv2
import numpy as np

from labcal.arrays import Pixels
from labcal.targets.chessboard import Chessboard

SB, SUBPIX = "findChessboardCornersSB", "findChessboardCorners with cornerSubPix"
WAYS = (SB, SUBPIX)
_WINDOW_SHARE, _MOST_WINDOW = 0.3, 11
"""Half the window of `cornerSubPix`, of the least distance of corners, and px: to no other corner."""


def opencv_corners(picture: np.ndarray, board: Chessboard, way: str) -> Pixels:
    """Return the corners that OpenCV finds, shape (n, 2), px; none where it finds no board.

    Parameters
    ----------
    picture : ndarray of uint8, shape (h, w)
    board : Chessboard
    way : str
        One of :data:`WAYS`.
    """
    size = (board.cols, board.rows)
    if way == SB:
        found, corners = cv2.findChessboardCornersSB(picture, size)
    else:
        flags = cv2.CALIB_CB_ADAPTIVE_THRESH + cv2.CALIB_CB_NORMALIZE_IMAGE
        found, corners = cv2.findChessboardCorners(picture, size, flags=flags)
    if not found:
        return np.zeros((0, 2))
    rough = np.asarray(corners, dtype=np.float64).reshape(-1, 2)
    if way == SB:
        return rough
    apart = np.linalg.norm(np.diff(rough.reshape(board.rows, board.cols, 2), axis=1), axis=-1).min()
    half = int(np.clip(_WINDOW_SHARE * apart, 2, _MOST_WINDOW))
    criteria = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 50, 1e-4)
    fine = cv2.cornerSubPix(
        picture, np.ascontiguousarray(rough[:, None], dtype=np.float32), (half, half), (-1, -1), criteria
    )
    return np.asarray(fine, dtype=np.float64).reshape(-1, 2)
