"""The scatter of RMS errors from one calibration to the next: all points share the errors of theirs."""

from dataclasses import dataclass
from functools import cached_property
from math import sqrt

import numpy as np
from jaxtyping import Float64
from scipy.stats import chi2

from labcal.geometry.rigid_part import without_rigid_part
from labcal.reconstruct.point_budget import PointBudget
from labcal.rng import generator

DRAWS = 4000
_RANGE = (2.5, 97.5)
"""Percentiles."""
WITHIN = 0.15
"""Relative difference of found and foretold RMS errors up to which a forecast counts as met."""
MOST_SETS = 1000


@dataclass(frozen=True)
class ErrorScatter:
    """The mean square of the errors of points after one calibration, as a random variable.

    It is the mean variance by the points' own pixels plus a sum of squares of independent normal variables
    with the variances :attr:`shares`: eigenvalues of the calibration's share in the mean square.

    Attributes
    ----------
    noise_mm2 : float
        Mean square by the pixels of the points themselves; of many points it hardly scatters.
    shares : float64 array, (directions,)
        Variances by independent errors of the calibration, mm squared, the largest first.
    """

    noise_mm2: float
    shares: Float64[np.ndarray, " directions"]

    @classmethod
    def of_places(cls, budget: PointBudget) -> "ErrorScatter":
        """Return that of errors in the frame of the first camera."""
        return cls._of(budget, budget.derivatives(np.arange(len(budget))))

    @classmethod
    def of_shape(cls, budget: PointBudget) -> "ErrorScatter":
        """Return that of what a rigid alignment onto the truth leaves: errors of shape and size.

        Notes
        -----
        The noise of single points loses 6 of 3 n parts, too, which is left in.
        """
        return cls._of(budget, without_rigid_part(budget.derivatives(np.arange(len(budget))), budget.point))

    @classmethod
    def _of(cls, budget: PointBudget, derivatives: Float64[np.ndarray, "n 3 parameters"]) -> "ErrorScatter":
        by = derivatives.reshape(-1, derivatives.shape[2]) @ root_of(budget.parameters)
        shares = np.linalg.eigvalsh(by.T @ by / len(budget))[::-1]
        noise = float(np.trace(budget.noise, axis1=1, axis2=2).mean())
        return cls(noise, np.maximum(shares, 0.0))

    @property
    def rms_mm(self) -> float:
        """RMS error over many calibrations."""
        return sqrt(self.noise_mm2 + float(self.shares.sum()))

    @property
    def calibration_mm(self) -> float:
        """The calibration's share in it."""
        return sqrt(float(self.shares.sum()))

    @cached_property
    def _single(self) -> Float64[np.ndarray, " draws"]:
        random = generator(0, "rehearsal", "range")
        normal = random.standard_normal((DRAWS, len(self.shares)))
        return np.asarray(np.sqrt(self.noise_mm2 + normal**2 @ self.shares))

    @property
    def range_mm(self) -> tuple[float, float]:
        """Range of the RMS error after a single calibration, in 95 of 100."""
        low, high = np.percentile(self._single, _RANGE)
        return float(low), float(high)

    @property
    def median_mm(self) -> float:
        """RMS error that half of all calibrations stay below."""
        return float(np.median(self._single))

    def range_of_mean(self, sets: int) -> tuple[float, float]:
        """Return the range of the RMS error over so many calibrations, in 95 of 100.

        Notes
        -----
        The sum of squares is distributed about as a multiple of a chi-square variable of the same mean and
        variance (Satterthwaite 1946).
        """
        total = float(self.shares.sum())
        if total == 0.0:
            return self.rms_mm, self.rms_mm
        freedom = sets * total**2 / float((self.shares**2).sum())
        low, high = (
            sqrt(self.noise_mm2 + total * float(chi2.ppf(0.01 * at, freedom)) / freedom) for at in _RANGE
        )
        return low, high

    @property
    def relative_sigma(self) -> float:
        """Standard deviation of the mean square after one calibration, over its expectation."""
        return sqrt(2.0 * float((self.shares**2).sum())) / self.rms_mm**2

    @cached_property
    def sets_needed(self) -> int:
        """Fewest calibrations whose RMS error is within 15% of the expected one in 95 of 100."""
        few, many = 0, MOST_SETS
        while many - few > 1:
            middle = (few + many) // 2
            low, high = self.range_of_mean(middle)
            fine = low >= (1.0 - WITHIN) * self.rms_mm and high <= (1.0 + WITHIN) * self.rms_mm
            few, many = (few, middle) if fine else (middle, many)
        return many


def root_of(
    covariance: Float64[np.ndarray, "parameters parameters"],
) -> Float64[np.ndarray, "parameters parameters"]:
    """Return a root R of a covariance, R R' = C, whose parameters may have different units."""
    scale = np.sqrt(np.diagonal(covariance))
    scale = np.where(scale > 0.0, scale, 1.0)  # so that px, rad and mm are alike
    variance, axes = np.linalg.eigh(covariance / np.outer(scale, scale))
    return np.asarray(scale[:, None] * axes * np.sqrt(np.maximum(variance, 0.0)))
