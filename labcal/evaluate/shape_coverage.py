"""Planes and rigid motions of points against the truth, by sigmas from the joint covariance of the rig.

Both are in the frame of the first camera, which the rig and the truth have in common: no alignment takes
a part of their errors away.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float64, Int64

from labcal.arrays import Vectors3
from labcal.correspond.detections import Detections
from labcal.correspond.points import Points
from labcal.distributions import chi2_quantile
from labcal.evaluate.aligned_budget import PointOrigin, full_budget
from labcal.evaluate.distance_coverage import CONFIDENCE
from labcal.geometry.cross_matrices import cross_matrices
from labcal.geometry.poses import rigid_alignment
from labcal.reconstruct.point_budget import PointBudget

_FEWEST = 6
"""Points of a view, or common to two, from which on a plane or a motion is fitted to them."""
_FLAT = 1e-2
"""RMS distance of true points from their plane, as a share of their extent, up to which they lie in one."""


@dataclass(frozen=True)
class ShapeCoverage:
    """Shares of planes and motions within 95% of their truth, and how many there were.

    All are of one calibration, whose errors they share: they are far fewer independent values than they are.

    Attributes
    ----------
    planes, motions : float
        NaN where there is none.
    n_planes, n_motions : int
        Of views, and of each view to the next one.
    """

    planes: float = float("nan")
    motions: float = float("nan")
    n_planes: int = 0
    n_motions: int = 0


def shape_coverage(
    points: Points, true: Vectors3, origin: PointOrigin, detections: Detections
) -> ShapeCoverage:
    """Return the shares of planes and rigid motions within 95% of their truth by their own covariances.

    Parameters
    ----------
    points : Points
        All with a solution, in the world of the rig, its first camera's frame.
    true : ndarray, shape (n, 3)
        Their true places in the frame of the true first camera, mm.
    origin : PointOrigin
        The rig that triangulated them.
    detections : Detections
        What they come from.

    Notes
    -----
    A plane is that of least squares through the points of a view whose true places lie in one: its distance
    and two slopes, with 3 degrees of freedom. A motion brings the dots that a view and the next one have in
    common from the one to the other: a rotation and a shift, with 6. Both are linear in errors of points to
    first order, by the fit's own pseudoinverse.
    """
    budget = full_budget(points, origin, detections)
    if budget is None:
        return ShapeCoverage()
    error = points.point - true
    lines = [np.flatnonzero(points.view == view) for view in points.views]
    planes = [_plane(budget, error, true, own) for own in lines if len(own) >= _FEWEST]
    motions = [_motion(budget, error, true, *_common(points, one, other)) for one, other in pairwise(lines)]
    squares = [square for square in planes if square is not None]
    moved = [square for square in motions if square is not None]
    return ShapeCoverage(_share(squares, 3), _share(moved, 6), len(squares), len(moved))


def _share(squares: list[float], freedom: int) -> float:
    if not squares:
        return float("nan")
    return float((np.array(squares) <= chi2_quantile(CONFIDENCE, freedom)).mean())


def _plane(
    budget: PointBudget, error: Vectors3, true: Vectors3, own: Int64[np.ndarray, " k"]
) -> float | None:
    """Return the normalised square of a plane's error; None where the points do not lie in one."""
    p = true[own] - true[own].mean(axis=0)
    _, extent, axes = np.linalg.svd(p, full_matrices=False)
    if not extent[2] <= _FLAT * extent[1]:
        return None
    normal = axes[2]
    design = np.column_stack([np.ones(len(own)), p @ axes[0], p @ axes[1]])
    fit = np.linalg.pinv(design)[:, :, None] * normal  # parameters by places of points
    return _square(fit, error[own], budget.noise[own], budget.derivatives(own), budget.parameters)


def _motion(
    budget: PointBudget,
    error: Vectors3,
    true: Vectors3,
    one: Int64[np.ndarray, " k"],
    other: Int64[np.ndarray, " k"],
) -> float | None:
    """Return the normalised square of a motion's error; None where too few dots are common to both views."""
    if len(one) < _FEWEST:
        return None
    R = rigid_alignment(true[other], true[one])[:3, :3]
    turned = -cross_matrices(true[other] - true[other].mean(axis=0))
    design = np.concatenate([turned, np.broadcast_to(np.eye(3), turned.shape)], axis=2)
    fit = np.linalg.pinv(design.reshape(-1, 6)).reshape(6, len(one), 3)
    return _square(
        fit,
        error[other] - error[one] @ R.T,
        budget.noise[other] + R @ budget.noise[one] @ R.T,
        budget.derivatives(other) - R @ budget.derivatives(one),
        budget.parameters,
    )


def _square(
    fit: Float64[np.ndarray, "m k 3"],
    error: Vectors3,
    noise: Float64[np.ndarray, "k 3 3"],
    shared: Float64[np.ndarray, "k 3 parameters"],
    parameters: Float64[np.ndarray, "parameters parameters"],
) -> float:
    """Return the square of what a linear fit makes of errors, in units of its own covariance."""
    off = np.einsum("mkx,kx->m", fit, error)
    by = np.einsum("mkx,kxp->mp", fit, shared)
    covariance = np.einsum("mkx,kxy,nky->mn", fit, noise, fit) + by @ parameters @ by.T
    scale = np.sqrt(np.diagonal(covariance))
    return float((off / scale) @ np.linalg.solve(covariance / scale[:, None] / scale, off / scale))


def _common(
    points: Points, one: Int64[np.ndarray, " n"], other: Int64[np.ndarray, " m"]
) -> tuple[Int64[np.ndarray, " k"], Int64[np.ndarray, " k"]]:
    """Return the lines of the dots that two views have in common."""
    rows = {tuple(index): line for index, line in zip(points.index[one].tolist(), one.tolist(), strict=True)}
    pairs = [
        (rows[tuple(index)], line)
        for index, line in zip(points.index[other].tolist(), other.tolist(), strict=True)
        if tuple(index) in rows
    ]
    both = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    return both[:, 0], both[:, 1]
