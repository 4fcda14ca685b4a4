"""A ChArUco board as OpenCV has it: for finding its markers and for drawing them."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float64

from labcal.targets.charuco import CharucoBoard, MarkerDictionary, Pattern


@dataclass(frozen=True)
class Markers:
    """The markers of a board.

    Attributes
    ----------
    corner : ndarray, shape (n, 2)
        Lower left corners in the target's frame, mm.
    is_black : ndarray of bool, shape (n, cells, cells)
        The cells of each, top row first, the black border included.
    """

    corner: Float64[np.ndarray, "n 2"]
    is_black: Bool[np.ndarray, "n cells cells"]


def opencv_dictionary(name: MarkerDictionary) -> cv2.aruco.Dictionary:
    """Return OpenCV's set of markers."""
    return cv2.aruco.getPredefinedDictionary(int(getattr(cv2.aruco, name.value)))


def opencv_board(board: CharucoBoard) -> cv2.aruco.CharucoBoard:
    """Return the board as OpenCV has it, in mm and in its own frame."""
    made = cv2.aruco.CharucoBoard(
        board.squares,
        board.square_mm,
        board.marker_mm,
        opencv_dictionary(board.dictionary),
        np.arange(board.first_id, board.first_id + board.marker_count, dtype=np.int32),
    )
    made.setLegacyPattern(board.pattern is Pattern.LEGACY)
    return made


def markers(board: CharucoBoard) -> Markers:
    """Return the places and the cells of a board's markers."""
    made = opencv_board(board)
    dictionary = opencv_dictionary(board.dictionary)
    cells = dictionary.markerSize + 2
    pictures = [dictionary.generateImageMarker(int(i), cells, borderBits=1) for i in made.getIds()]
    corners = np.array(made.getObjPoints(), dtype=np.float64).reshape(-1, 3)
    outlines = board.points_from_opencv(corners).reshape(-1, 4, 3)
    return Markers(outlines[..., :2].min(axis=1), np.stack(pictures) == 0)
