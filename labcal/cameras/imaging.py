"""Rays of pixels and images of points, as a camera returns them."""

from dataclasses import dataclass

from labcal.arrays import Mask, Pixels, Vectors3


@dataclass(frozen=True)
class Rays:
    """Rays of pixels: a point on each, its unit direction, and whether there is a ray at all."""

    origin: Vectors3
    direction: Vectors3
    ok: Mask


@dataclass(frozen=True)
class Projection:
    """Images of points; NaN and not ok for what the camera cannot image."""

    q: Pixels
    ok: Mask
