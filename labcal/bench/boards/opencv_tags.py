"""Corners of the tags of an AprilGrid as OpenCV finds them, each of its ways."""

import cv2
import numpy as np

from labcal.arrays import Pixels
from labcal.targets.april_grid import AprilGrid
from labcal.targets.charuco_opencv import opencv_dictionary

SUBPIX, APRILTAG = "ArUco with CORNER_REFINE_SUBPIX", "ArUco with CORNER_REFINE_APRILTAG"
WAYS = (SUBPIX, APRILTAG)
_METHODS = {SUBPIX: cv2.aruco.CORNER_REFINE_SUBPIX, APRILTAG: cv2.aruco.CORNER_REFINE_APRILTAG}


def opencv_tags(picture: np.ndarray, grid: AprilGrid, way: str) -> Pixels:
    """Return the corners of the tags that OpenCV reads, shape (n, 2), px; none where it reads none.

    Parameters
    ----------
    picture : ndarray of uint8, shape (h, w)
    grid : AprilGrid
    way : str
        One of :data:`WAYS`.
    """
    parameters = cv2.aruco.DetectorParameters()
    parameters.markerBorderBits = grid.border_cells
    parameters.cornerRefinementMethod = _METHODS[way]
    detector = cv2.aruco.ArucoDetector(opencv_dictionary(grid.dictionary), parameters)
    corners, _, _ = detector.detectMarkers(picture)
    return np.asarray(corners, dtype=np.float64).reshape(-1, 2)
