"""Grey values around a dot: of the code ring, of the gap within it and of the paper beyond, by angle."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float64

from labcal.detect.grey import GreyPicture
from labcal.detect.medians import DEVIATIONS_A_MAD
from labcal.targets.coded_dots import QUIET, RING_INNER, RING_OUTER

PER_SECTOR = 8
"""Angles sampled in a sector."""
_DOT = (0.0, 0.2, 0.4)
RING_RADII = tuple(RING_INNER + share * (RING_OUTER - RING_INNER) for share in (0.35, 0.5, 0.65))
"""Radii at which the ring is sampled, in radii of the dot."""
GAP_RADII = tuple(1.0 + share * (RING_INNER - 1.0) for share in (0.4, 0.5, 0.6))
PAPER_RADII = tuple(RING_OUTER + share * (QUIET - RING_OUTER) for share in (0.4, 0.5, 0.6))
_ROUNDS = 4
_OUTLIER = 2.0 * DEVIATIONS_A_MAD
_LEAST_OUTLIER = 0.04
_LEAST_LIGHT = 0.1
"""Of that on the dot: a plane that is far off would make it negative."""


@dataclass(frozen=True)
class RingSamples:
    """Grey values around one dot: 0 is white paper, 1 as dark as the dot.

    Attributes
    ----------
    gap, ring, paper : ndarray, shape (angles,)
        Within the ring, in its middle and beyond it; angles run as in the picture, clockwise.
    step : float
        From the dot to the paper, in grey values.
    """

    gap: Float64[np.ndarray, " angles"]
    ring: Float64[np.ndarray, " angles"]
    paper: Float64[np.ndarray, " angles"]
    step: float


def sample_ring(
    grey: GreyPicture, centre: np.ndarray, root: np.ndarray, tilt: np.ndarray, sectors: int
) -> RingSamples:
    """Return what is seen around a dot, in the light that falls on it.

    The dot's ellipse determines the projective map from the print to the picture up to those maps that keep a
    circle: a turn, and a displacement of the circle's points as in the hyperbolic plane (Coxeter 1998,
    Non-Euclidean Geometry, chapter 4), which is the perspective within the mark and vanishes where that is
    small. The light is a plane through the paper in the gap, and through
    what agrees with it beyond the ring; outliers are left out.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture; beyond the frame it is taken for NaN.
    centre : ndarray, shape (2,)
        Of the dot, px.
    root : ndarray, shape (2, 2)
        Root of the matrix of its outline: it maps the unit circle to the ellipse.
    tilt : ndarray, shape (2,)
        The displacement of the circle's centre in radii, less than a third.
    sectors : int
        Of the ring.
    """
    count = PER_SECTOR * sectors
    angle = 2.0 * np.pi * (np.arange(count) + 0.5) / count
    radii = np.array([*_DOT, *GAP_RADII, *RING_RADII, *PAPER_RADII])
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    flat = displaced(radii[:, None, None] * circle, tilt)
    q = (flat @ root.T + centre).astype(np.float32)
    value = cv2.remap(
        grey, q[..., 0], q[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=np.nan
    ).astype(np.float64)
    dot, gap, ring, paper = (part.mean(axis=0) for part in np.split(value, 4))
    dark = float(np.nanmean(dot))
    plane = _plane(flat[4], gap, dark, np.array([np.nanmedian(gap), 0.0, 0.0]))
    plane = _plane(np.concatenate([flat[4], flat[10]]), np.concatenate([gap, paper]), dark, plane)
    step = float(plane[0] - dark)
    if not step > 0.0:
        nothing = np.full(count, np.nan)
        return RingSamples(nothing, nothing, nothing, step)
    light = [np.maximum(1.0 + (where @ plane[1:]) / plane[0], _LEAST_LIGHT) for where in flat[[4, 7, 10]]]
    gap, ring, paper = (
        (here * plane[0] - part) / (here * step) for here, part in zip(light, (gap, ring, paper), strict=True)
    )
    return RingSamples(gap, ring, paper, step)


def displaced(flat: np.ndarray, tilt: np.ndarray) -> np.ndarray:
    """Map points by the projective map that keeps the unit circle and moves its centre to `tilt`.

    Parameters
    ----------
    flat : ndarray, shape (..., 2)
        In radii.
    tilt : ndarray, shape (2,)
        In radii. That of the opposite sign is the inverse.
    """
    size = float(np.hypot(*tilt))
    if size == 0.0:
        return flat
    along = tilt / size
    x, y = flat @ along, flat @ np.array([-along[1], along[0]])
    over = 1.0 / (1.0 + size * x)
    moved = np.stack([(x + size) * over, np.sqrt(1.0 - size**2) * y * over], axis=-1)
    return np.asarray(moved @ np.array([along, [-along[1], along[0]]]))


def _plane(places: np.ndarray, value: np.ndarray, dark: float, first: np.ndarray) -> np.ndarray:
    """Return level and slopes of the light on paper, by least squares without outliers from a first plane."""
    known, plane = np.isfinite(value), first
    design = np.concatenate([np.ones((len(places), 1)), places], axis=1)
    for _ in range(_ROUNDS):
        step = plane[0] - dark
        if known.sum() < len(value) // 2 or not step > 0.0:
            return np.full(3, np.nan)
        off = value - design @ plane
        size = _OUTLIER * float(np.median(np.abs(off[known])))
        usable = known & (np.abs(off) <= max(size, _LEAST_OUTLIER * step))
        if usable.sum() < len(value) // 3:
            return plane
        plane = np.linalg.lstsq(design[usable], value[usable], rcond=None)[0]
    return plane
