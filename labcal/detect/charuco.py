"""From a picture of a ChArUco board to its corners: markers by OpenCV, places by a fit of our own."""

import cv2
import numpy as np

from labcal.detect.corners.corners import Corners, measured_corners
from labcal.detect.corners.picture_corners import picture_corners
from labcal.detect.dots import PictureDots
from labcal.detect.flags import Refusal
from labcal.detect.grey import GreyPicture
from labcal.detect.lattice.lattice import Lattice
from labcal.detect.lattice.smoothness import is_smooth
from labcal.detect.settings import DetectSettings
from labcal.detect.stage_settings.corner import CornerSettings
from labcal.targets.charuco import CharucoBoard
from labcal.targets.charuco_opencv import opencv_board


def detect_charuco(grey: GreyPicture, board: CharucoBoard, settings: DetectSettings) -> PictureDots:
    """Find the board's corners in one picture.

    A corner is known where OpenCV recognises the markers beside it, or by its place among corners that are.
    Where it is, the two edges that cross there determine (:mod:`labcal.detect.corners.corners`).

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    board : CharucoBoard
        The board to look for.
    settings : DetectSettings

    Returns
    -------
    PictureDots
        Without outlines; a corner that is known by its markers and cannot be measured is flagged ``bad-fit``,
        or ``cut`` at the frame. Refused where no marker is recognised, or not in the board's places, where
        fewer than four corners, or corners of one line only, are measured, and where they lie on no smooth
        surface.
    """
    found = _recognised(grey, board, settings.corner)
    if isinstance(found, Refusal):
        return picture_corners(Corners.none(), grey, found, settings)
    corners = measured_corners(grey, board, found, settings)
    ok = np.flatnonzero([fit is not None for fit in corners.fits])
    if not found.spans_a_plane() or not corners.select(ok).spans_a_plane():
        return picture_corners(corners, grey, Refusal.TOO_FEW_DOTS, settings)
    lattice = Lattice({(int(corners.index[k, 0]), int(corners.index[k, 1])): int(k) for k in ok})
    smooth = is_smooth(lattice, corners.seen_at, settings.grid)
    return picture_corners(corners, grey, None if smooth else Refusal.GRID_INCONSISTENT, settings)


def _recognised(grey: GreyPicture, board: CharucoBoard, settings: CornerSettings) -> Corners | Refusal:
    """Return the corners that OpenCV knows by their markers, roughly in place."""
    cut = settings.range_cut_percent
    large_enough = min(grey.shape) >= settings.min_picture_px
    low, high = np.percentile(grey, [cut, 100.0 - cut]) if large_enough else (0.0, 0.0)
    if high <= low:
        return Refusal.NO_MARKERS
    bytes_ = np.clip((grey - low) * (255.0 / (high - low)), 0, 255).astype(np.uint8)
    parameters = cv2.aruco.DetectorParameters()
    parameters.minMarkerPerimeterRate = min(0.03, 4.0 * settings.min_marker_px / max(grey.shape))
    detector = cv2.aruco.CharucoDetector(opencv_board(board), detectorParams=parameters)
    corners, ids, _, marker_ids = detector.detectBoard(bytes_)
    markers = 0 if marker_ids is None else len(marker_ids)
    if markers == 0:
        return Refusal.NO_MARKERS
    if ids is None or len(ids) == 0:
        return Refusal.OTHER_BOARD if markers >= settings.other_board_markers else Refusal.TOO_FEW_DOTS
    index = board.from_opencv(np.asarray(ids, dtype=np.int64).ravel())
    return Corners(index, np.asarray(corners, dtype=np.float64).reshape(-1, 2), [None] * len(index))
