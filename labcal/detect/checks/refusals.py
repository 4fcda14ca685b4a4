"""The refusal of a whole picture: because of its light or blur, or because hardly a dot is measured."""

import numpy as np

from labcal.detect.dots import PictureDots
from labcal.detect.flags import NOT_MEASURABLE, Refusal
from labcal.detect.grey import AnyPicture, GreyPicture, clipping, grey_picture
from labcal.detect.outlines.outlines import Outlines
from labcal.detect.settings import DetectSettings
from labcal.detect.stage_settings.quality import QualitySettings
from labcal.geometry.two_by_two import eigenvalues

_PALE = 0.6, 0.3
"""Levels of the middle and of the darkest tenth of what is not burnt out, of the largest one, above which ink
is too light."""
_UNREAD = (
    Refusal.NO_MARKERS,
    Refusal.MARKERS_UNREADABLE,
    Refusal.NO_CODED_DOTS,
    Refusal.NO_CHESSBOARD,
    Refusal.TORN_CORNERS,
)
"""Refusals of boards for which too much light may be the reason."""
_CAUSED = (Refusal.NO_DOTS, Refusal.TOO_FEW_DOTS, Refusal.NO_GRID, Refusal.NO_RINGS)


def cause(refusal: Refusal, grey: GreyPicture, outlines: Outlines, settings: DetectSettings) -> Refusal:
    """Return the cause of there being no dots or no grid, if the picture shows one."""
    if refusal not in _CAUSED:
        return refusal
    limits = settings.quality
    low, high = clipping(grey, settings.edge.clipped_value_share)
    clipped = np.count_nonzero(grey <= low) + np.count_nonzero(grey >= high)
    if low < high and clipped > limits.max_clipped_picture_share * grey.size:
        return Refusal.SATURATED
    minor = np.sqrt(eigenvalues(outlines.shape)[:, 0])
    blur = outlines.blur
    if len(minor) < settings.grid.min_dots:
        return refusal
    blurred = np.median(blur / minor) > limits.soft_share and np.median(blur) > limits.soft_px
    return Refusal.BLURRED if blurred else refusal


def in_this_light(dots: PictureDots, image: AnyPicture, settings: DetectSettings) -> PictureDots:
    """Return the dots of a picture whose board is not found, refused because of its light where that is why.

    Parameters
    ----------
    dots : PictureDots
    image : ndarray, shape (h, w), (h, w, 3) or (h, w, 4)
        The picture, in which black and white may be as black and white as can be: boards are printed so.
    settings : DetectSettings
    """
    if dots.refusal not in _UNREAD:
        return dots
    grey = grey_picture(image)
    _, high = clipping(grey, settings.edge.clipped_value_share)
    below = grey[grey < high]
    some = 0 < below.size < (1.0 - settings.quality.max_clipped_picture_share) * grey.size
    if some and (np.quantile(below, (0.5, 0.1)) > np.multiply(_PALE, high)).all():
        return dots.refused(Refusal.SATURATED, dots.detail)
    return dots


def hardly_measured(dots: PictureDots, settings: QualitySettings) -> bool:
    """Tell whether hardly any of the dots that are whole in the picture could be measured."""
    usable = int(dots.ok.sum())
    whole = usable + sum(flag in NOT_MEASURABLE for flag in dots.flag)
    return usable == 0 or usable < settings.min_usable_share * whole
