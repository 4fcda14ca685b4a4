"""The shares of noise and calibration in the covariances of points, in JSON documents and for people."""

from dataclasses import dataclass

import numpy as np

from labcal.arrays import PointCovariances
from labcal.reconstruct.frames.framed_budget import FramedBudget
from labcal.reconstruct.point_budget import Budget, PointBudget
from labcal.reconstruct.scale.scaled_budget import ScaledBudget


@dataclass(frozen=True)
class BudgetShares:
    """The key ``budget`` in the JSON document: root mean squares over the points with a solution, mm."""

    kind: str
    """``full``, or ``noise`` if it was asked for or the rig states no covariance of its calibration."""
    noise_mm: float
    """Share of the noise of pixels."""
    calibration_mm: float | None
    """Share of the calibration; null if it is not in the covariances."""


def budget_shares(budget: PointBudget | FramedBudget | ScaledBudget) -> BudgetShares:
    """Return the shares over all points."""
    full = budget.kind is Budget.FULL
    calibration = _rms_mm(budget.calibration) if full else None
    return BudgetShares(budget.kind.value, _rms_mm(budget.noise), calibration)


def budget_words(budget: BudgetShares | None) -> str:
    """Return the shares as a line for people, after those of a result; nothing of a fitted method."""
    if budget is None:
        return ""
    words = f"\nRMS sigma of a point by noise {budget.noise_mm:.3g} mm, by the calibration "
    known = budget.calibration_mm
    return words + ("not in the covariances" if known is None else f"{known:.3g} mm")


def _rms_mm(covariance: PointCovariances) -> float:
    """Return the root mean square standard deviation of points, without those that have none; else NaN."""
    variance = np.trace(covariance, axis1=1, axis2=2)
    stated = variance[np.isfinite(variance)]
    return float(np.sqrt(stated.mean())) if len(stated) else float("nan")
