"""Uncertainty of corners beside white that is clipped: their edges are seen from one side only."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from labcal.arrays import Pixels
from labcal.detect.corners.corner_fit import SettledCorner
from labcal.detect.corners.hard_edges import edge_normals, pixels_crossed, place_covariance
from labcal.detect.corners.printed_fit import PrintedCorner
from labcal.detect.dots import PictureDots
from labcal.detect.grey import GreyPicture, clipping
from labcal.detect.settings import DetectSettings

_OF_ONE_SIDE = 0.035
"""Standard deviation of an edge that pixels meet all alike, px, for a blur of 1 px and none of its step seen.

Where both sides are seen, what pixels and their rounding make of a profile is the same on either side and
cancels. From drawn boards within 1 degree of the pixels' rows, white of 1.1 to 2.4 times the clipping value,
blurs of 0.6 to 1.8 px: 0.029, 0.018, 0.010 and 0.007 px for 1.6 times and 0.6, 0.8, 1.2 and 1.8 px.
"""
_MOST_CLIPPED = 0.4
"""Clipped share of a board beyond which its white is burnt out: half of it is white."""


def burnt_words(grey: GreyPicture, corners: Pixels, settings: DetectSettings) -> str:
    """Return a sentence, behind a space, on a board whose white is burnt out; empty where it is not.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    corners : ndarray, shape (n, 2)
        Where the board's corners are, px.
    settings : DetectSettings
    """
    most = clipping(grey, settings.corner.clipped_value_share)[1]
    last = np.array(grey.shape[::-1]) - 1
    (left, top), (right, bottom) = np.clip([corners.min(axis=0), corners.max(axis=0) + 1.0], 0, last).astype(
        int
    )
    board = grey[top:bottom, left:right]
    if board.size == 0 or np.count_nonzero(board >= most) <= _MOST_CLIPPED * board.size:
        return ""
    return " Its white is as bright as the picture can be: shorten the exposure time."


def with_clipped_edges(
    dots: PictureDots, fits: Sequence[SettledCorner | None], grey: GreyPicture, settings: DetectSettings
) -> PictureDots:
    """Return the corners of a picture with what clipped white adds to their covariances.

    Parameters
    ----------
    dots : PictureDots
    fits : sequence of SettledCorner or None
        Of the corners, in their order.
    grey : ndarray, shape (h, w)
        The picture.
    settings : DetectSettings
    """
    most = clipping(grey, settings.corner.clipped_value_share)[1]
    if np.isinf(most):
        return dots
    covariance = dots.covariance.copy()
    for k, fit in enumerate(fits):
        if fit is not None and not isinstance(fit, PrintedCorner):
            covariance[k] += clipped_edge_covariance(fit, most)
    return replace(dots, covariance=covariance)


def clipped_edge_covariance(fit: SettledCorner, most: float) -> np.ndarray:
    """Return the covariance of a corner's place that clipped white adds, px squared, shape (2, 2).

    It is zero where the white is below the clipping value, and where clipped pixels are a part of the fit, as
    of edges without blur. An edge that is turned against the pixels runs through m of them across its length,
    evenly: its mean place is off by 1 / m.

    Parameters
    ----------
    fit : SettledCorner
    most : float
        Grey value from which on pixels are clipped; infinite where none are.
    """
    step = fit.step
    unseen = (fit.state.item(6) + 0.5 * step - most) / step
    if not unseen > 0.0 or (fit.window.value >= most).any():
        return np.zeros((2, 2))
    normals = edge_normals(fit)
    variances = np.zeros(2)
    for edge, (blur, normal) in enumerate(zip(fit.state[4:6].tolist(), normals, strict=True)):
        crossed = pixels_crossed(normal, fit.window.offset)
        variances[edge] = (_OF_ONE_SIDE * min(unseen, 1.0) / (blur**1.5 * crossed)) ** 2
    return place_covariance(normals, variances)
