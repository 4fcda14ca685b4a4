"""Markers of other boards, hidden in a picture while one of several ChArUco boards is looked for.

A marker of the board's dictionary that lies where its chessboard would go on says that the board is another
one. Beside a board whose ids are known it says nothing.
"""

import cv2
import numpy as np

from labcal.detect.corners.seen_markers import seen_markers
from labcal.detect.grey import GreyPicture
from labcal.detect.settings import DetectSettings
from labcal.targets.board_set import BoardSet
from labcal.targets.charuco import CharucoBoard


def without_other_markers(
    grey: GreyPicture, boards: BoardSet, number: int, settings: DetectSettings
) -> GreyPicture:
    """Return a picture in which markers with ids of the other boards are filled with one grey value.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
    boards : BoardSet
    number : int
        Of the board that is looked for, a ChArUco board.
    settings : DetectSettings

    Returns
    -------
    ndarray
        `grey` itself where none is seen.
    """
    board = boards.targets[number]
    others = [
        other
        for other in boards.targets
        if other is not board and isinstance(other, CharucoBoard) and other.dictionary == board.dictionary
    ]
    cut = settings.corner.range_cut_percent
    large_enough = min(grey.shape) >= settings.corner.min_picture_px
    low, high = np.percentile(grey, [cut, 100.0 - cut]) if large_enough and others else (0.0, 0.0)
    if high <= low:
        return grey
    bytes_ = np.clip((grey - low) * (255.0 / (high - low)), 0, 255).astype(np.uint8)
    seen = seen_markers(bytes_, board, settings.corner)
    filled = grey.copy()
    for other in others:
        for corners in seen.on(other).corners:
            inside = np.zeros(grey.shape, dtype=np.uint8)
            cv2.fillConvexPoly(inside, np.round(corners).astype(np.int32), 1)
            filled[inside > 0] = np.median(grey[inside > 0])
    return filled
