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
) -> tuple[Mask, Mask, np.ndarray]:
    """Tell which pairs of outlines one flat round dot explains, which have another size, and their diameters.

    Parameters
    ----------
    cameras : tuple of Camera
    p : ndarray, shape (n, 3)
        Where the dots would be, mm.
    marks : MarkPixels
    lines : ndarray of int, shape (n, 2)
        Of the two pixels of each pair.

    Returns
    -------
    likely : ndarray of bool, shape (n,)
        One dot explains both outlines, of the stated diameter where there is one.
    other_size : ndarray of bool, shape (n,)
        One dot does, but not of the stated diameter.
    diameter_mm : ndarray, shape (n,)
    """
    if not len(p):
        return np.zeros(0, dtype=bool), np.zeros(0, dtype=bool), np.zeros(0)
    discs = fit_discs(outlines_at(cameras, p, marks.outline[lines], marks.pixels.covariance[lines]))
    likely = discs.chi_square < chi2_upper_quantile(_NEVER, int(discs.freedom[0]))
    stated = marks.diameter_mm[lines[:, 0]]
    with np.errstate(invalid="ignore"):
        other = np.abs(2.0 * discs.radius_mm[:, 0] / stated - 1.0) > _OTHER_SIZE
    return likely & ~other, likely & other, 2.0 * discs.radius_mm[:, 0]
