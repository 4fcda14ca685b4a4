"""Markers of a board's dictionary that OpenCV reads in a picture."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float64, Int64

from labcal.detect.stage_settings.corner import CornerSettings
from labcal.targets.charuco import CharucoBoard
from labcal.targets.charuco_opencv import opencv_dictionary


@dataclass(frozen=True)
class SeenMarkers:
    """Markers of a board's dictionary that are read in a picture.

    Attributes
    ----------
    number : ndarray of int, shape (n,)
        Their ids in the dictionary.
    corners : ndarray, shape (n, 4, 2)
        Where their corners are, px, in OpenCV's order: clockwise from the upper left one.
    """

    number: Int64[np.ndarray, " n"]
    corners: Float64[np.ndarray, "n 4 2"]

    @classmethod
    def none(cls) -> "SeenMarkers":
        """Return no markers."""
        return cls(np.zeros(0, dtype=np.int64), np.zeros((0, 4, 2)))

    def select(self, which: Int64[np.ndarray, " m"]) -> "SeenMarkers":
        """Return some of them."""
        return SeenMarkers(self.number[which], self.corners[which])

    def on(self, board: CharucoBoard) -> "SeenMarkers":
        """Return those whose ids the board has."""
        own = (self.number >= board.first_id) & (self.number < board.first_id + board.marker_count)
        return self.select(np.flatnonzero(own))


def seen_markers(picture: np.ndarray, board: CharucoBoard, settings: CornerSettings) -> SeenMarkers:
    """Read the markers of the board's dictionary in a picture.

    Parameters
    ----------
    picture : ndarray of uint8, shape (h, w)
    board : CharucoBoard
        Its dictionary counts alone: the ids may be of another board.
    settings : CornerSettings
    """
    parameters = cv2.aruco.DetectorParameters()
    parameters.minMarkerPerimeterRate = min(0.03, 4.0 * settings.min_marker_px / max(picture.shape))
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    detector = cv2.aruco.ArucoDetector(opencv_dictionary(board.dictionary), parameters)
    corners, number, _ = detector.detectMarkers(picture)
    if number is None:
        return SeenMarkers.none()
    return SeenMarkers(
        np.asarray(number, dtype=np.int64).ravel(), np.asarray(corners, dtype=np.float64).reshape(-1, 4, 2)
    )
