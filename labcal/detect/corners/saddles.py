"""Saddle points of a picture at which two straight edges cross: candidates for the corners of chessboards."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask, Pixels
from labcal.detect.corners.saddle_rings import READING, RingLimits, read_rings
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
    xx, yy, xy = _second_derivatives(smooth)
    strength = xy * xy - xx * yy
    strongest = cv2.dilate(strength, np.ones((5, 5), dtype=np.uint8))
    usual = float(np.median(np.abs(strength[::4, ::4])))
    least = max(settings.noise_factor**2 * usual, _FAINTEST * float(strength.max()))
    y, x = np.nonzero((strength == strongest) & (strength > least))
    order = np.argsort(-strength[y, x], kind="stable")[: settings.max_saddles]
    y, x = y[order], x[order]
    inside = (x > 0) & (y > 0) & (x < grey.shape[1] - 1) & (y < grey.shape[0] - 1)
    y, x = y[inside], x[inside]
    gradient = 0.5 * np.stack([smooth[y, x + 1] - smooth[y, x - 1], smooth[y + 1, x] - smooth[y - 1, x]])
    a, b, c = xx[y, x], xy[y, x], yy[y, x]
    step = np.stack([c * gradient[0] - b * gradient[1], a * gradient[1] - b * gradient[0]]) / strength[y, x]
    near = np.abs(step).max(axis=0) < _NEWTON_PX if len(x) else np.zeros(0, dtype=bool)
    place = np.stack([x + step[0], y + step[1]], axis=-1)[near].astype(np.float64)
    rings = read_rings(smooth, place, settings.limits(RingLimits)) if len(place) else np.zeros((0, READING))
    ok = np.isfinite(rings[:, 0])
    return Saddles(place[ok], rings[ok, :2].copy(), rings[ok, 2] > 0, rings[ok, 3].copy())


def _second_derivatives(smooth: GreyPicture) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the derivatives xx, yy and xy by central differences."""
    second = np.array([1.0, -2.0, 1.0], dtype=np.float32)
    first, one = np.array([-0.5, 0.0, 0.5], dtype=np.float32), np.ones(1, dtype=np.float32)
    return (
        cv2.sepFilter2D(smooth, -1, second, one),
        cv2.sepFilter2D(smooth, -1, one, second),
        cv2.sepFilter2D(smooth, -1, first, first),
    )
