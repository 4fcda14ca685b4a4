"""Sectors of a ring as blur mixes them: each with its neighbours, and with the paper beside the ring."""

import numpy as np
from jaxtyping import Float64
from scipy.special import ndtr

from labcal.detect.marks.ring_samples import PER_SECTOR, RING_RADII
from labcal.targets.coded_dots import RING_INNER, RING_OUTER

MIDDLE = PER_SECTOR // 2
"""Samples of a sector that are read: its middle half."""


def samples_of_sectors(sectors: int) -> np.ndarray:
    """Return which samples of a ring are read of every sector, for every start of the first sector.

    Parameters
    ----------
    sectors : int
        Of the ring.

    Returns
    -------
    ndarray of int, shape (PER_SECTOR, sectors, MIDDLE)
        The first sector begins with the sample whose number is the start.
    """
    start = np.arange(PER_SECTOR)[:, None, None] + (PER_SECTOR - MIDDLE) // 2
    at = start + PER_SECTOR * np.arange(sectors)[:, None] + np.arange(MIDDLE)
    return np.asarray(at % (PER_SECTOR * sectors))


def mixing(root: np.ndarray, blur: float, sectors: int) -> Float64[np.ndarray, "starts sectors sectors"]:
    """Return the matrix by which sectors' grey values follow from the printed ones, for every start.

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
    parts = [ndtr((RING_OUTER - R) * radial) - ndtr((RING_INNER - R) * radial) for R in RING_RADII]
    at = samples_of_sectors(sectors)
    rays = 2.0 * np.pi / count * (np.arange(PER_SECTOR)[:, None] + PER_SECTOR * np.arange(sectors))
    off = angle[at][..., None] - rays[:, None, None, :]
    off = (off + np.pi) % (2.0 * np.pi) - np.pi
    after = ndtr(off * across[at][..., None])
    # Between two rays; the ray behind the observer, where the angle jumps, is far off either way.
    between = after - np.roll(after, -1, axis=-1)
    between = np.where(between < -0.5, between + 1.0, between)  # noqa: PLR2004 -- half of the jump
    share = between * np.mean(parts, axis=0)[at][..., None]
    return np.asarray(share.mean(axis=2))
