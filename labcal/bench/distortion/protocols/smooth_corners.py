"""Corners of a board moved to a smooth surface: a homography and a thin-plate smoothing spline."""

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Vectors3
from labcal.geometry.projective_map import homogeneous, projective_map

_SMOOTHING = 5.0
"""Of SciPy's spline, which has half of StereoComplex's kernel: there it is 10."""


def smooth_corners(p_target: Vectors3, q: Float64[np.ndarray, "n 2"]) -> Float64[np.ndarray, "n 2"]:
    """Return the images of corners on a smooth surface; what is not measured (NaN) stays so.

    Parameters
    ----------
    p_target : float64 array, (n, 3)
        Corners in the target's frame, mm, with z = 0.
    q : float64 array, (n, 2)
        Measured positions, px.

    Notes
    -----
    What a homography leaves is smoothed by a thin-plate spline over the board (Wahba 1990), in the unit of
    the median distance of a corner from the middle. The weights by which StereoComplex spares outliers are
    left out: no corner here is 3 px off, where they begin.
    """
    from scipy.interpolate import RBFInterpolator  # noqa: PLC0415 -- takes a quarter of a second

    seen = np.isfinite(q).all(axis=1)
    plane = p_target[seen, :2] - p_target[seen, :2].mean(axis=0)
    plane /= np.median(np.linalg.norm(plane, axis=1))
    image = homogeneous(plane) @ projective_map("smooth corners", plane, q[seen]).T
    base = image[:, :2] / image[:, 2:]
    spline = RBFInterpolator(plane, q[seen] - base, smoothing=_SMOOTHING, kernel="thin_plate_spline")
    smoothed = np.full_like(q, np.nan)
    smoothed[seen] = base + spline(plane)
    return smoothed
