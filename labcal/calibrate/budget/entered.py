"""The observations that an adjustment ended with, and the problem that they make."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.problem import AdjustmentProblem, ViewsEliminated
from labcal.calibrate.adjustment.rounds import Adjusted
from labcal.calibrate.adjustment.state import Freedom, RigState
from labcal.cameras.optics import INTRINSICS


@dataclass(frozen=True)
class Entered:
    """An adjustment at its end: without outliers and eccentricity, with its variance component."""

    adjusted: Adjusted
    observations: Observations

    @classmethod
    def of(cls, adjusted: Adjusted, observations: Observations) -> "Entered":
        """Return what entered an adjustment of these observations, which are centroids as measured."""
        seen = observations.moved(-adjusted.eccentricity).where(~adjusted.outlier)
        seen = seen.scattered(adjusted.scatter_px**2)
        return cls(adjusted, seen)

    @property
    def state(self) -> RigState:
        """Cameras, poses and dots at the end."""
        return self.adjusted.state

    @property
    def cameras(self) -> int:
        """Number of parameters of all cameras: lenses and poses."""
        return int(self.adjusted.layout.pose[-1].stop)

    def prior_by_parameter(self) -> Float64[np.ndarray, " cameras"]:
        """Return the inverse variances of the prior by parameter of the cameras, 0 where it has none."""
        weights = np.zeros(self.cameras)
        for own, weight in zip(self.adjusted.layout.lens, self.adjusted.prior.weight, strict=False):
            weights[own.start + INTRINSICS : own.stop] = weight
        return weights

    def chi_square(self) -> float:
        """Return the sum of squared residuals in units of their variances."""
        white = self.observations.whitener.whiten(self.state.residuals(self.observations).T)
        return float((white**2).sum())

    def linearised(self, dots: Float64[np.ndarray, "coordinates free"]) -> ViewsEliminated:
        """Return the normal equations at the end where dots may move along the columns of a basis."""
        freedom = Freedom(self.adjusted.layout.freedom.lenses, dots)
        return AdjustmentProblem(self.observations, freedom, prior=self.adjusted.prior).linearize(self.state)

    def with_fixed_dots(self) -> ViewsEliminated:
        """Return the normal equations at the end with the dots where they are."""
        return self.linearised(np.zeros((self.state.dots.size, 0)))
