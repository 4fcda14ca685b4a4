"""Corners of a ChArUco board as OpenCV finds them: as its detector leaves them, and with `cornerSubPix`."""

import cv2
import numpy as np

from labcal.arrays import Pixels
from labcal.targets.charuco import CharucoBoard
from labcal.targets.charuco_opencv import opencv_board

DETECTED, SUBPIX = "detectBoard", "detectBoard with cornerSubPix"
WAYS = (DETECTED, SUBPIX)
_MOST_WINDOW = 11
"""Half the window of `cornerSubPix`, px; it ends at the nearest marker, which would draw the corner."""


def opencv_charuco_corners(picture: np.ndarray, board: CharucoBoard) -> dict[str, Pixels]:
    """Return the corners that OpenCV finds, by way, in the order of the board's indices, or NaN.

    Markers are refined by OpenCV's own `CORNER_REFINE_SUBPIX`, and corners by the detector's own refinement.

    Parameters
    ----------
    picture : ndarray of uint8, shape (h, w)
    board : CharucoBoard
    """
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    detector = cv2.aruco.CharucoDetector(opencv_board(board), cv2.aruco.CharucoParameters(), parameters)
    corners, ids, _, _ = detector.detectBoard(picture)
    found = {way: np.full((board.count, 2), np.nan) for way in WAYS}
    if ids is None or len(ids) == 0:
        return found
    q = np.asarray(corners, dtype=np.float64).reshape(-1, 2)
    col, row = board.from_opencv(np.asarray(ids, dtype=np.int64).ravel()).T
    number = row * board.cols + col
    found[DETECTED][number] = q
    away = np.linalg.norm(q[:, None] - q[None], axis=-1)
    apart = float(away[away > 0.0].min()) if len(q) > 1 else float(_MOST_WINDOW)
    half = int(np.clip(board.corner_gap * apart, 2, _MOST_WINDOW))
    criteria = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 50, 1e-4)
    rough = np.ascontiguousarray(q[:, None], dtype=np.float32)
    fine = cv2.cornerSubPix(picture, rough, (half, half), (-1, -1), criteria)
    found[SUBPIX][number] = np.asarray(fine, dtype=np.float64).reshape(-1, 2)
    return found
