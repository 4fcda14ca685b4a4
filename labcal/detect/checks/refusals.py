"""The refusal of a whole picture: because of its light or blur, or because hardly a dot is measured."""

import numpy as np

from labcal.detect.dots import PictureDots
from labcal.detect.flags import NOT_MEASURABLE, Refusal
from labcal.detect.grey import GreyPicture, clipping
from labcal.detect.outlines.outlines import Outlines
from labcal.detect.settings import DetectSettings
from labcal.detect.stage_settings.quality import QualitySettings
from labcal.geometry.two_by_two import eigenvalues

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


def hardly_measured(dots: PictureDots, settings: QualitySettings) -> bool:
    """Tell whether hardly any of the dots that are whole in the picture could be measured."""
    usable = int(dots.ok.sum())
    whole = usable + sum(flag in NOT_MEASURABLE for flag in dots.flag)
    return usable == 0 or usable < settings.min_usable_share * whole
