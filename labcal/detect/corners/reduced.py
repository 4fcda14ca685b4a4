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
    factor = _first_factor(grey, settings)
    while factor >= 1:
        yield _reduced(grey, factor)
        factor //= 2


def coarser_pictures(grey: GreyPicture, settings: DetectSettings) -> Iterator[Reduced]:
    """Return the picture reduced by twice as much as the coarsest one of :func:`reduced_pictures`.

    Means over more pixels have less noise: they show corners that blur and noise hide in finer pictures.
    There is none of a small picture.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
    settings : DetectSettings
    """
    factor = 2 * _first_factor(grey, settings)
    if min(grey.shape) >= factor * settings.corner.min_picture_px and grey.max() > grey.min():
        yield _reduced(grey, factor)


def _first_factor(grey: GreyPicture, settings: DetectSettings) -> int:
    """Return by how much the picture that is searched first is reduced."""
    factor = 1
    while max(grey.shape) / factor > settings.saddle.first_side_px:
        factor *= 2
    return factor


def _reduced(grey: GreyPicture, factor: int) -> Reduced:
    """Return a picture reduced by a whole number."""
    if factor == 1:
        return Reduced(grey, factor)
    height, width = (length // factor for length in grey.shape)
    whole = grey[: height * factor, : width * factor]
    return Reduced(cv2.resize(whole, (width, height), interpolation=cv2.INTER_AREA), factor)
