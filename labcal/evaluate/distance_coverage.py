"""Distances of points against the truth, in units of their sigma from the joint covariance of the rig."""

import numpy as np

from labcal.arrays import Vectors3
from labcal.correspond.detections import Detections
from labcal.correspond.points import Points
from labcal.distributions import chi2_quantile
from labcal.evaluate.aligned_budget import PointOrigin, full_budget

CONFIDENCE = 0.95


def distance_coverage(points: Points, true: Vectors3, origin: PointOrigin, detections: Detections) -> float:
    """Return the share of distances within 95% of their truth by their own sigmas.

    Points of one rig share the errors of its calibration, so that a distance is known better than two points
    are. An alignment changes no distance.

    Parameters
    ----------
    points : Points
        All with a solution, in the world of the rig.
    true : ndarray, shape (n, 3)
        Their true places, mm, in any frame.
    origin : PointOrigin
        The rig that triangulated them.
    detections : Detections
        What they come from.

    Returns
    -------
    float
        Of each point and the one half a table farther on; NaN where the points do not have the full budget of
        this rig and these dots, or are fewer than two.
    """
    half = len(points) // 2
    budget = full_budget(points, origin, detections)
    if budget is None or half == 0:
        return float("nan")
    one, other = np.arange(half), np.arange(half) + half
    apart = points.point[one] - points.point[other]
    length = np.linalg.norm(apart, axis=1)
    along = apart / length[:, None]
    shared = budget.derivatives(one) - budget.derivatives(other)
    moved = np.einsum("ni,nip->np", along, shared)
    variance = np.einsum("ni,nij,nj->n", along, budget.noise[one] + budget.noise[other], along)
    variance += ((moved @ budget.parameters) * moved).sum(axis=1)
    off = length - np.linalg.norm(true[one] - true[other], axis=1)
    return float((off**2 <= chi2_quantile(CONFIDENCE, 1) * variance).mean())
