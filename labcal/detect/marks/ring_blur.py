"""Grey values around a coded dot as blur mixes the sectors of its ring with each other and with paper."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64
from scipy.special import ndtr

from labcal.detect.marks.ring_samples import GAP_RADII, PAPER_RADII, PER_SECTOR, RING_RADII
from labcal.targets.coded_dots import RING_INNER, RING_OUTER

_MIDDLE = PER_SECTOR // 2
"""Samples of a sector from which it is read at first: its middle half."""


@dataclass(frozen=True)
class RingBlur:
    """Shares of printed sectors in what is seen around a dot, for every start of the first sector.

    Attributes
    ----------
    between : ndarray, shape (starts, angles, sectors)
        Share of a sector at an angle, of light that comes from the ring.
    gap, ring, paper : ndarray, shape (angles,)
        Share of light that comes from the ring, within it, in it and beyond it.
    """

    between: Float64[np.ndarray, "starts angles sectors"]
    gap: Float64[np.ndarray, " angles"]
    ring: Float64[np.ndarray, " angles"]
    paper: Float64[np.ndarray, " angles"]

    def sectors(self, values: Float64[np.ndarray, " angles"]) -> Float64[np.ndarray, "starts sectors"]:
        """Return means over the middle half of every sector, for every start."""
        return np.asarray(values[self._middles()].mean(axis=-1))

    def mixing(self) -> Float64[np.ndarray, "starts sectors sectors"]:
        """Return the matrix by which sectors' grey values follow from the printed ones, for every start."""
        at = self._middles()
        seen = self.between[np.arange(PER_SECTOR)[:, None, None], at] * self.ring[at][..., None]
        return np.asarray(seen.mean(axis=2))

    def _middles(self) -> np.ndarray:
        """Return the samples of the middle half of every sector, shape (starts, sectors, samples)."""
        sectors = self.between.shape[-1]
        start = np.arange(PER_SECTOR)[:, None, None] + (PER_SECTOR - _MIDDLE) // 2
        at = start + PER_SECTOR * np.arange(sectors)[:, None] + np.arange(_MIDDLE)
        return np.asarray(at % (PER_SECTOR * sectors))


def ring_blur(root: np.ndarray, blur: float, sectors: int) -> RingBlur:
    """Return how blur mixes a ring.

    A sector is a patch between two rays and two ellipses, which are nearly straight over the blur's width;
    what of a Gaussian falls into it is a product of two differences of error functions.

    Parameters
    ----------
    root : ndarray, shape (2, 2)
        Root of the matrix of the dot's outline: it maps the unit circle to the ellipse.
    blur : float
        Standard deviation of an edge, px.
    sectors : int
        Of the ring.
    """
    count = PER_SECTOR * sectors
    angle = 2.0 * np.pi * (np.arange(count) + 0.5) / count
    unit = np.stack([np.cos(angle), np.sin(angle)])
    # Distances from a ray and from an ellipse, px a radian and px a radius.
    middle = 0.5 * (RING_INNER + RING_OUTER)
    across = middle * abs(np.linalg.det(root)) / np.hypot(*(root @ unit)) / blur
    radial = 1.0 / np.hypot(*np.linalg.solve(root, unit)) / blur
    gap, ring, paper = (
        np.mean([ndtr((RING_OUTER - R) * radial) - ndtr((RING_INNER - R) * radial) for R in radii], axis=0)
        for radii in (GAP_RADII, RING_RADII, PAPER_RADII)
    )
    rays = 2.0 * np.pi / count * (np.arange(PER_SECTOR)[:, None] + PER_SECTOR * np.arange(sectors))
    off = angle[:, None] - rays[:, None, :]
    off = (off + np.pi) % (2.0 * np.pi) - np.pi
    after = ndtr(off * across[:, None])
    # Between two rays; the ray behind the observer, where the angle jumps, is far off either way.
    between = after - np.roll(after, -1, axis=-1)
    between = np.where(between < -0.5, between + 1.0, between)  # noqa: PLR2004 -- half of the jump
    return RingBlur(between, gap, ring, paper)
