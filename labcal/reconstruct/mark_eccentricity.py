"""Eccentricity of dots on a surface of any shape: corrected by the tilt that their outlines show."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask, Vectors3
from labcal.calibrate.eccentricity import CorrectedEccentricity
from labcal.cameras.camera import Camera
from labcal.cameras.derivatives import imaged
from labcal.cameras.dot_image import SAMPLES, outlined_images
from labcal.cameras.triangulation import triangulate
from labcal.correspond.mark_measurement import MarkPixels
from labcal.correspond.named_matching import match_named
from labcal.correspond.named_pixels import NamedPixels
from labcal.distributions import chi2_upper_quantile
from labcal.reconstruct.disc_fit import DiscFits, Outlines3, fit_discs

_NO_DISC = 1e-6
"""Probability of outlines by noise below which they are not those of a flat round dot."""
_PAIR = 2


@dataclass(frozen=True)
class CentredMarks:
    """Pixels of marks from which the eccentricity of dots is taken, as far as it is known.

    Attributes
    ----------
    pixels : NamedPixels
        Their covariances hold the uncertainty of the correction; where there is none, the size of the
        eccentricity.
    corrected : ndarray of bool, shape (n,)
        Mask of the pixels that are corrected.
    uncorrected : ndarray of bool, shape (n,)
        Mask of the pixels of dots that are not; corners of tags have no eccentricity.
    size : CorrectedEccentricity
        Of those corrected.
    diameter_mm : ndarray, shape (n,)
        Diameter of a dot as its outlines and its place have it; NaN where it is not known.
    """

    pixels: NamedPixels
    corrected: Mask
    uncorrected: Mask
    size: CorrectedEccentricity
    diameter_mm: Float64[np.ndarray, " n"]


def centred_marks(cameras: dict[str, Camera], marks: MarkPixels) -> CentredMarks:
    """Return the pixels of dots' centres: their centroids without the eccentricity.

    Parameters
    ----------
    cameras : dict of str to Camera
    marks : MarkPixels
        Pixels of a name are one dot.

    Notes
    -----
    The eccentricity depends on the tilt of a dot against the line of sight and on its size (Ahn, Warnecke and
    Kotowski 1999). Both follow from the outlines of that one dot in two pictures or more, without its
    neighbours: the surface may be bent or have steps.
    """
    pixels = marks.pixels
    is_dot = np.isfinite(marks.outline).all(axis=(1, 2))
    found = match_named(pixels, tuple(cameras))
    line = _lines(pixels, tuple(cameras))
    shift = np.zeros((len(pixels), 2))
    more = np.zeros((len(pixels), 2, 2))
    diameter = np.full(len(pixels), np.nan)
    known = np.zeros(len(pixels), dtype=bool)
    everyone = list(cameras.values())
    for chosen, rows in found.groups():
        places = list(chosen)
        group = rows[is_dot[line[rows][:, places]].all(axis=1)] if len(places) >= _PAIR else rows[:0]
        own = [everyone[at] for at in places]
        if not len(group):
            continue
        q, covariance = found.q[group][:, places], found.covariance[group][:, places]
        p = triangulate(own, q, covariance).point
        there = np.isfinite(p).all(axis=1)
        p, of = p[there], line[group[there]][:, places]
        if not len(p):
            continue
        discs = fit_discs(outlines_at(own, p, marks.outline[of], pixels.covariance[of]))
        is_disc = discs.chi_square < chi2_upper_quantile(_NO_DISC, int(discs.freedom[0]))
        for number, camera in enumerate(own):
            mean, spread = _eccentricity(camera, p, discs)
            right = is_disc & np.isfinite(mean).all(axis=1)
            lines = of[:, number]
            shift[lines] = np.where(right[:, None], mean, 0.0)
            whole = np.nan_to_num(mean[:, :, None] * mean[:, None, :])
            more[lines] = np.where(right[:, None, None], spread, whole)
            known[lines] = right
            diameter[lines] = 2.0 * discs.radius_mm[:, 0]
    centred = NamedPixels(
        pixels.view, pixels.camera, pixels.point, pixels.position - shift, pixels.covariance + more
    )
    size = CorrectedEccentricity.of(shift[known])
    return CentredMarks(centred, known, is_dot & ~known, size, diameter)


def _lines(pixels: NamedPixels, cameras: tuple[str, ...]) -> np.ndarray:
    """Return the line of every point in every camera, in the order of `match_named`; -1 where none is."""
    place = {name: number for number, name in enumerate(cameras)}
    seen = list(zip(pixels.view.tolist(), pixels.point.tolist(), strict=True))
    numbers = {key: number for number, key in enumerate(dict.fromkeys(seen))}
    line = np.full((len(numbers), len(cameras)), -1)
    for at, (key, camera) in enumerate(zip(seen, pixels.camera.tolist(), strict=True)):
        if camera in place:
            line[numbers[key], place[camera]] = at
    return line


def outlines_at(
    cameras: Sequence[Camera], p: Vectors3, outline: np.ndarray, covariance: np.ndarray
) -> Outlines3:
    """Return outlines of dots with the derivatives of pixels at their places."""
    centres = np.array([camera.rays(np.array([[0.0, 0.0]])).origin[0] for camera in cameras])
    towards = centres[None] - p[:, None]
    towards = (towards / np.linalg.norm(towards, axis=2, keepdims=True)).sum(axis=1)
    return Outlines3(
        by_point=np.stack([imaged(camera, p).by_point for camera in cameras], axis=1),
        outline=outline,
        sigma=np.sqrt(np.trace(covariance, axis1=2, axis2=3) / 2.0),
        towards=towards / np.linalg.norm(towards, axis=1, keepdims=True),
    )


def _eccentricity(camera: Camera, p: Vectors3, discs: DiscFits) -> tuple[np.ndarray, np.ndarray]:
    """Return the expected eccentricity of dots in a picture, px, and its covariance by the tilts."""
    n, k = discs.radius_mm.shape
    normal = discs.normal.reshape(-1, 3)
    across = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal), axis=1)])
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    other = np.cross(normal, across)
    angle = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES
    circle = np.cos(angle)[:, None] * across[:, None] + np.sin(angle)[:, None] * other[:, None]
    centres = np.repeat(p, k, axis=0)
    rims = centres[:, None] + discs.radius_mm.reshape(-1)[:, None, None] * circle
    seen = outlined_images(camera.project, centres, rims)
    each = (seen.centroid - seen.centre).reshape(n, k, 2)
    best, other_best = each[:, 0], each[:, -1]
    half = 0.5 * (each[:, [1, 3]] - each[:, [2, 4]])
    share = discs.rival[:, None]
    mean = (1.0 - share) * best + share * other_best
    between = other_best - best
    spread = np.einsum("nki,nkj->nij", half, half)
    weight = (discs.rival * (1.0 - discs.rival))[:, None, None]
    spread = spread + weight * between[:, :, None] * between[:, None, :]
    return mean, np.nan_to_num(spread)
