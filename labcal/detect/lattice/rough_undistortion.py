"""Undistortion of a wide lens's picture by a rough guess, after which a grid's lines are nearly straight."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from labcal.arrays import PixelCovariances, Pixels
from labcal.detect.grey import GreyPicture
from labcal.detect.outlines.outlines import Outlines
from labcal.detect.stage_settings.grid import GridSettings

_LIMIT = 1.3
"""Rad: beyond this angle to the axis a plane runs off; the map goes on straight."""
_STRAIGHT_ON, _STEEPEST = float(np.tan(_LIMIT)), float(1.0 + np.tan(_LIMIT) ** 2)


@dataclass(frozen=True)
class RoughUndistortion:
    """The map from the picture of an equidistant fisheye to a perspective one with the same focal length.

    Attributes
    ----------
    centre : ndarray, shape (2,)
        Where the axis meets the picture, px.
    focal : float
        px; infinite for a lens that is perspective already.
    """

    centre: np.ndarray
    focal: float

    @property
    def is_none(self) -> bool:
        """True if the lens is perspective already."""
        return self.focal == inf

    def undistort(self, q: Pixels) -> Pixels:
        """Return where pixels lie in the undistorted picture, px."""
        if self.is_none:
            return q
        away, angle = self._polar(q)
        flat: np.ndarray = self.centre + away * (self._radius(angle) / angle)[..., None]
        return flat

    def distort(self, q: Pixels) -> Pixels:
        """Return the pixels of places in the undistorted picture."""
        if self.is_none:
            return q
        away, radius = self._polar(q)
        beyond = _LIMIT + (radius - _STRAIGHT_ON) / _STEEPEST
        angle = np.where(radius < _STRAIGHT_ON, np.arctan(radius), beyond)
        seen: Pixels = self.centre + away * (angle / radius)[..., None]
        return seen

    def slopes(self, q: Pixels) -> PixelCovariances:
        """Return the derivatives of :meth:`undistort` at pixels, shape (..., 2, 2)."""
        if self.is_none:
            return np.broadcast_to(np.eye(2), (*q.shape[:-1], 2, 2)).copy()
        away, angle = self._polar(q)
        outwards = away / np.maximum(np.linalg.norm(away, axis=-1, keepdims=True), 1e-9)
        around = self._radius(angle) / angle
        along = np.where(angle < _LIMIT, 1.0 + self._radius(angle) ** 2, _STEEPEST)
        radial = outwards[..., :, None] * outwards[..., None, :]
        slopes: np.ndarray = around[..., None, None] * np.eye(2) + (along - around)[..., None, None] * radial
        return slopes

    def outlines(self, outlines: Outlines) -> Outlines:
        """Return outlines as they lie in the undistorted picture."""
        if self.is_none:
            return outlines
        slopes = self.slopes(outlines.centre)
        shape = slopes @ outlines.shape @ np.swapaxes(slopes, -1, -2)
        return Outlines(self.undistort(outlines.centre), shape, outlines.hole, outlines.blur)

    def _polar(self, q: Pixels) -> tuple[np.ndarray, np.ndarray]:
        """Return the vectors from the centre, and their lengths over the focal length, nowhere zero."""
        away = q - self.centre
        return away, np.asarray(np.maximum(np.linalg.norm(away, axis=-1) / self.focal, 1e-9))

    @staticmethod
    def _radius(angle: np.ndarray) -> np.ndarray:
        """Return the undistorted radius of an angle, over the focal length."""
        straight = _STRAIGHT_ON + _STEEPEST * (angle - _LIMIT)
        radius: np.ndarray = np.where(angle < _LIMIT, np.tan(np.minimum(angle, _LIMIT)), straight)
        return radius


NONE = RoughUndistortion(np.zeros(2), float("inf"))
"""For a lens that images straight lines straight."""


def fisheyes(size: tuple[int, int], fields_deg: Sequence[float]) -> list[RoughUndistortion]:
    """Return equidistant fisheyes about the middle of a picture (width, height, px), by diagonal field."""
    centre = (np.array(size, dtype=np.float64) - 1.0) / 2.0
    diagonal = float(np.hypot(*size))
    return [RoughUndistortion(centre, diagonal / float(np.radians(field))) for field in fields_deg]


def fisheyes_of(grey: GreyPicture, settings: GridSettings) -> list[RoughUndistortion]:
    """Return the fisheyes that are tried on a picture."""
    return fisheyes((grey.shape[1], grey.shape[0]), settings.fisheye_fields_deg)
