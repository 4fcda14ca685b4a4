"""Pictures of twice the size, in which small squares are as large as what looks for them."""

from dataclasses import dataclass

import cv2
import numpy as np

from labcal.arrays import Pixels
from labcal.detect.grey import GreyPicture
from labcal.detect.settings import DetectSettings

_MOST = 4
"""Longer side of a picture that is enlarged, in that of the picture that is searched first."""


@dataclass(frozen=True)
class Enlarged:
    """A picture that is enlarged.

    Attributes
    ----------
    grey : ndarray, shape (2 h, 2 w)
        Interpolated.
    """

    grey: GreyPicture

    def in_full(self, places: np.ndarray) -> Pixels:
        """Return places (..., 2) in pixels of the full picture."""
        # The middle of the first pixel is a quarter of one before that of the full picture's.
        return np.asarray(0.5 * places - 0.25)


def enlarged_picture(grey: GreyPicture, settings: DetectSettings) -> Enlarged | None:
    """Return a picture of twice the size; None of one that is too large for that, or too small for a board.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
    settings : DetectSettings
    """
    height, width = grey.shape
    if min(grey.shape) < settings.corner.min_picture_px or not grey.max() > grey.min():
        return None
    if max(grey.shape) > _MOST * settings.saddle.first_side_px:
        return None
    twice = cv2.resize(grey, (2 * width, 2 * height), interpolation=cv2.INTER_CUBIC)
    return Enlarged(np.asarray(twice))
