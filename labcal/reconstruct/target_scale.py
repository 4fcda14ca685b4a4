"""Size of a reconstructed target against its declared one, which shifts along epipolar lines change.

Rays of two cameras still meet where the pictures of one are shifted along the epipolar lines: points are then
nearer or farther, and what they show is smaller or larger than it is.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Int64

from labcal.arrays import Vectors3
from labcal.cameras.rig import Rig
from labcal.correspond.matching import Matches, rows_by_name
from labcal.distributions import chi2_upper
from labcal.errors import InputError
from labcal.geometry.poses import rigid_alignment
from labcal.reconstruct.point_budget import Budget, PointBudget
from labcal.targets.target import Target

CHANCE = 1e-3
"""Probability below which it is worth a warning; points keep their flags."""
_FEWEST = 4
"""Dots of a view that has a size of its own."""


@dataclass(frozen=True)
class TargetScale:
    """Mean scale of a reconstructed target over its declared one.

    Attributes
    ----------
    ppm : float
        Too large by so many parts per million.
    sigma_ppm : float
        Standard deviation by the noise of pixels, the covariance of the calibration and its print.
    p_value : float
        Probability of so large a difference, or a larger one, by these alone.
    """

    ppm: float
    sigma_ppm: float
    p_value: float

    @property
    def beyond_chance(self) -> bool:
        """True if chance explains it but once in a thousand good tables."""
        return self.p_value < CHANCE


def target_scale(
    rig: Rig, matches: Matches, budget: PointBudget, target: Target, usable: Bool[np.ndarray, " n"]
) -> TargetScale | None:
    """Return the scale of a target; None where too few dots are there or the rig states no covariance.

    Parameters
    ----------
    rig : Rig
    matches : Matches
    budget : PointBudget
        Of the reconstructed points, in the order of the matches.
    target : Target
    usable : bool array, (n,)
        Mask of the points that count.

    Notes
    -----
    With m the dots' declared places around their mean and R the rotation of each view's alignment, the scale
    is ``sum (R m) p / sum m m``: linear in the points, so that its variance follows from their joint
    covariance without their being put together. Dots off on the print are the same ones in all views.
    """
    if budget.kind is Budget.NOISE or rig.covariance is None:
        return None
    rows, numbers = np.flatnonzero(usable), matches.index[:, 1] * target.cols + matches.index[:, 0]
    weight, size = _weights(matches, budget.point, target, rows, numbers)
    rows = np.flatnonzero((weight != 0.0).any(axis=1))
    if len(rows) < _FEWEST:
        return None
    w = weight[rows] / size
    scale = float((w * budget.point[rows]).sum())
    own = float(np.einsum("ni,nij,nj->", w, budget.noise[rows], w))
    moved = np.einsum("ni,nip->p", w, budget.derivatives(rows))
    print_share = np.zeros(len(target.points()))
    np.add.at(print_share, numbers[rows], np.linalg.norm(w, axis=1))
    own += rig.covariance.print_sigma_mm**2 * float((print_share**2).sum())
    variance = own + float(moved @ rig.covariance.matrix @ moved)
    ratio = (scale - 1.0) ** 2 / variance
    return TargetScale(1e6 * (scale - 1.0), 1e6 * float(np.sqrt(variance)), chi2_upper(ratio, 1))


def _weights(
    matches: Matches,
    point: Vectors3,
    target: Target,
    rows: Int64[np.ndarray, " rows"],
    numbers: Int64[np.ndarray, " n"],
) -> tuple[np.ndarray, float]:
    """Return R m of every point, zeros where it does not count, and the sum of m m."""
    weight, size, declared = np.zeros((len(matches), 3)), 0.0, target.points()
    for lines in rows_by_name(matches.view[rows]).values():
        own = rows[lines]
        if len(own) < _FEWEST:
            continue
        m = declared[numbers[own]]
        try:
            R = rigid_alignment(point[own], m)[:3, :3]
        except InputError:  # all on a line
            continue
        m = m - m.mean(axis=0)
        weight[own] = m @ R.T
        size += float((m**2).sum())
    return weight, size
