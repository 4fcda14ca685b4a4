"""Pictures that are reduced by whole numbers, in which boards are looked for before the full one."""

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np

from labcal.arrays import Pixels
from labcal.detect.grey import GreyPicture
from labcal.detect.settings import DetectSettings


@dataclass(frozen=True)
class Reduced:
    """A picture that is reduced.

    Attributes
    ----------
    grey : ndarray, shape (h, w)
        The means of squares of pixels.
    factor : int
        Their side, px.
    """

    grey: GreyPicture
    factor: int

    def in_full(self, places: np.ndarray) -> Pixels:
        """Return places (..., 2) in pixels of the full picture."""
        # The middle of the first reduced pixel is that of the pixels which it is the mean of.
        return np.asarray(self.factor * places + 0.5 * (self.factor - 1))


def reduced_pictures(grey: GreyPicture, settings: DetectSettings) -> Iterator[Reduced]:
    """Return a picture reduced by powers of two, coarse ones first, the full one last.

    There is none of a picture that is too small, or has one level only.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
    settings : DetectSettings
    """
    if min(grey.shape) < settings.corner.min_picture_px or not grey.max() > grey.min():
        return
    factor = 1
    while max(grey.shape) / factor > settings.saddle.first_side_px:
        factor *= 2
    while factor >= 1:
        height, width = (length // factor for length in grey.shape)
        level = grey
        if factor > 1:
            whole = grey[: height * factor, : width * factor]
            level = cv2.resize(whole, (width, height), interpolation=cv2.INTER_AREA)
        yield Reduced(level, factor)
        factor //= 2
