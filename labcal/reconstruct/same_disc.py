"""Candidates of plain dots judged by their outlines: could one flat round dot have both."""

import numpy as np
from jaxtyping import Int64

from labcal.arrays import Mask, Vectors3
from labcal.cameras.camera import Camera
from labcal.correspond.mark_measurement import MarkPixels
from labcal.distributions import chi2_upper_quantile
from labcal.reconstruct.disc_fit import fit_discs
from labcal.reconstruct.mark_eccentricity import outlines_at

_NEVER = 1e-6
"""Probability of outlines by noise below which they are not those of one dot."""
_OTHER_SIZE = 0.15
"""Share by which a dot departs from its stated diameter at most: ink spreads."""


def same_discs(
    cameras: tuple[Camera, Camera], p: Vectors3, marks: MarkPixels, lines: Int64[np.ndarray, "n 2"]
) -> Mask:
    """Tell which pairs of outlines one flat round dot explains, of its stated diameter where it has one.

    Parameters
    ----------
    cameras : tuple of Camera
    p : ndarray, shape (n, 3)
        Where the dots would be, mm.
    marks : MarkPixels
    lines : ndarray of int, shape (n, 2)
        Of the two pixels of each pair.
    """
    if not len(p):
        return np.zeros(0, dtype=bool)
    discs = fit_discs(outlines_at(cameras, p, marks.outline[lines], marks.pixels.covariance[lines]))
    likely = discs.chi_square < chi2_upper_quantile(_NEVER, int(discs.freedom[0]))
    stated = marks.diameter_mm[lines[:, 0]]
    with np.errstate(invalid="ignore"):
        other = np.abs(2.0 * discs.radius_mm[:, 0] / stated - 1.0) > _OTHER_SIZE
    return np.asarray(likely & ~other)
