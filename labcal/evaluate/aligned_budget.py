"""Covariances of points after a rigid alignment, which removes a part of the calibration's share.

In the datum of the rig, its first camera, all errors of the calibration are in the points. Where points are
brought onto a truth by a rigid motion, what moves all of them together is gone, and only the change of shape
and size is left. The full covariance of a point would then be far too large.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Int64

from labcal.arrays import PointCovariances
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.matching import match
from labcal.correspond.points import Points
from labcal.geometry.covariances import positive_definite
from labcal.geometry.rigid_part import without_rigid_part
from labcal.reconstruct.point_budget import Budget, PointBudget

_SAME = 0.01
"""Relative difference of variances up to which points are those of the full budget: pixels with the
eccentricity corrected move points a little, files are rounded."""


@dataclass(frozen=True)
class PointOrigin:
    """The rig in whose world points are, and whose errors are in them.

    Attributes
    ----------
    rig : Rig
    triangulated : bool
        True if it triangulated the points; False if it placed the target that a method was fitted to. What
        a method adds to the errors is its own.
    """

    rig: Rig
    triangulated: bool = True


def aligned_covariance(
    points: Points, origin: PointOrigin, detections: Detections
) -> PointCovariances | None:
    """Return the covariances of points after a rigid alignment onto their true places.

    Parameters
    ----------
    points : Points
        All with a solution; as they were reconstructed, in the world of the rig.
    origin : PointOrigin
        What they were reconstructed with.
    detections : Detections
        What they come from.

    Returns
    -------
    ndarray, shape (n, 3, 3), or None
        In the world of the rig, mm squared. None where the points do not have the budget of this rig and
        these dots: then their covariances stay as they are.

    Notes
    -----
    Derivatives by the cameras lose their rigid part. The noise of single points loses 6 of 3 n parts, too,
    which is left in.
    """
    budget = full_budget(points, origin, detections)
    if budget is None:
        return None
    left = without_rigid_part(budget.derivatives(np.arange(len(points))), points.point)
    return np.asarray(budget.noise + left @ budget.parameters @ left.transpose(0, 2, 1))


def full_budget(points: Points, origin: PointOrigin, detections: Detections) -> PointBudget | None:
    """Return the budget of points; None where they do not have the full one of this rig and these dots.

    Parameters
    ----------
    points, origin, detections
        As of :func:`aligned_covariance`.
    """
    rig = origin.rig
    pixels = _pixels(points, rig, detections)
    if rig.covariance is None or pixels is None:
        return None
    budget = PointBudget.of(rig, points.point, pixels, Budget.FULL)
    if not origin.triangulated:  # what the method adds of its own takes the place of the pixels' noise
        own: PointCovariances = points.covariance - budget.calibration
        return replace(budget, noise=own) if positive_definite(own).all() else None
    stated = np.trace(points.covariance, axis1=1, axis2=2)
    full = np.trace(budget.noise + budget.calibration, axis1=1, axis2=2)
    return budget if (np.abs(stated - full) <= _SAME * full).all() else None  # of NaN, too


def _pixels(points: Points, rig: Rig, detections: Detections) -> np.ndarray | None:
    """Return the covariances of the pixels of points; None where one is not known."""
    if not set(rig.cameras) <= set(detections.cameras):
        return None
    matches = match(detections, tuple(rig.cameras))
    rows = {key: row for row, key in enumerate(_keys(matches.view, matches.index))}
    found = [rows.get(key, -1) for key in _keys(points.view, points.index)]
    if -1 in found:
        return None
    covariance = matches.covariance[found]
    return covariance if positive_definite(covariance).all() else None


def _keys(view: np.ndarray, index: Int64[np.ndarray, "n 2"]) -> list[tuple[str, int, int]]:
    """Return view, column and row of each line."""
    return list(zip(view.tolist(), *index.T.tolist(), strict=True))
