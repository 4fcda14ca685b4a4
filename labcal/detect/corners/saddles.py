"""Saddle points of a picture at which two straight edges cross: candidates for the corners of chessboards."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask, Pixels
from labcal.detect.corners.saddle_rings import READING, RingLimits, read_rings
from labcal.detect.corners.saddle_strength import saddle_places, saddle_strength, strongest_places
from labcal.detect.grey import GreyPicture
from labcal.detect.stage_settings.saddle import SaddleSettings

_FAINTEST = 1e-5
"""Least curvature, squared, of the strongest in the picture: uneven light makes one of 0.003."""
_NEWTON_PX = 1.5
"""A saddle point is no farther from the pixel of the greatest curvature."""


@dataclass(frozen=True)
class Saddles:
    """Saddle points where two edges cross.

    Attributes
    ----------
    place : ndarray, shape (n, 2)
        px, good to a few tenths.
    edges : ndarray, shape (n, 2)
        Angles of the two edges from x to y (down), from 0 to pi, the smaller one first.
    white_between : ndarray of bool, shape (n,)
        Whether it is white from the first edge's angle to the second one's, and opposite.
    step : ndarray, shape (n,)
        From black to white, grey values.
    """

    place: Pixels
    edges: Float64[np.ndarray, "n 2"]
    white_between: Mask
    step: Float64[np.ndarray, " n"]

    def is_white(self, which: np.ndarray, angle: np.ndarray) -> np.ndarray:
        """Tell whether it is white beside some of the points, by number, in directions (rad)."""
        turned = np.mod(angle, np.pi)
        between = (turned > self.edges[which, 0]) & (turned < self.edges[which, 1])
        return np.asarray(between == self.white_between[which])


def find_saddles(grey: GreyPicture, settings: SaddleSettings) -> Saddles:
    """Return the saddle points of a picture.

    The determinant of the second derivatives is negative at a saddle point, zero on a straight edge, and
    positive at blobs; its most negative places are looked at, and the ring around each.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
    settings : SaddleSettings
    """
    smooth = cv2.GaussianBlur(grey, (0, 0), settings.blur_px)
    strength = saddle_strength(smooth)
    usual = float(np.median(np.abs(strength[::4, ::4])))
    least = max(settings.noise_factor**2 * usual, _FAINTEST * float(strength.max()))
    y, x = strongest_places(strength, least)
    if len(y) > settings.max_saddles:
        most = np.argsort(-strength[y, x], kind="stable")[: settings.max_saddles]
        y, x = y[most], x[most]
    place, which = saddle_places(smooth, strength, (y, x), _NEWTON_PX)
    rings = read_rings(smooth, place, settings.limits(RingLimits)) if len(place) else np.zeros((0, READING))
    ok = np.flatnonzero(np.isfinite(rings[:, 0]))
    ok = ok[np.argsort(-strength[y[which[ok]], x[which[ok]]], kind="stable")]
    return Saddles(place[ok], rings[ok, :2].copy(), rings[ok, 2] > 0, rings[ok, 3].copy())
