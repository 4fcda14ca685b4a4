"""Gross errors: dots far from the place that their neighbours predict, left out from the beginning.

One of 150 dots that is off by half the picture leads Zhang's method, which takes squares, to a camera from
which the adjustment does not come back. Later such dots are outliers.
"""

import numpy as np
from jaxtyping import Bool
from scipy.spatial import KDTree

from labcal.calibrate.adjustment.outliers import relative_to_neighbours
from labcal.correspond.detections import Detections
from labcal.geometry.projective_map import homogeneous, robust_homography
from labcal.targets.target import Target

_FEWEST = 8
"""Number of dots of a picture that is enough to separate most from a few."""
_OF_A_PITCH = 0.5
_TIMES = 5.0
"""Ratio of the distance of a wrong dot from the median of its neighbours to theirs: far from the middle of a
picture with strong distortion all are far from where a plane is seen without."""


def gross_errors(dots: Detections, target: Target) -> Bool[np.ndarray, " n"]:
    """Return a mask of dots whose error is at least half of the distance to the next dot.

    Parameters
    ----------
    dots : Detections
        Of one picture.
    target : Target

    Notes
    -----
    A homography that suits most dots leaves residuals that distortion makes alike for neighbours.
    """
    off = np.zeros(len(dots), dtype=bool)
    places = target.points(dots.index)
    if len(dots) < _FEWEST:
        return off
    H = robust_homography(places[:, :2], dots.position)
    if H is None:
        return off
    predicted = homogeneous(places[:, :2]) @ H.T
    with np.errstate(divide="ignore", invalid="ignore"):
        predicted = predicted[:, :2] / predicted[:, 2:]
    residual = np.nan_to_num(predicted - dots.position, nan=np.inf, posinf=np.inf, neginf=-np.inf)
    distances, _ = KDTree(dots.position).query(dots.position, k=2)
    least = _OF_A_PITCH * float(np.median(distances[:, 1]))
    candidates = np.flatnonzero(np.linalg.norm(residual, axis=1) > least)
    if len(candidates) == 0 or not np.isfinite(residual).all():
        return off
    apart, usual = relative_to_neighbours(residual, places, candidates)
    size = np.linalg.norm(apart, axis=1)
    off[candidates] = (size > least) & (size > _TIMES * usual)
    return off
