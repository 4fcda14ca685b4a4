"""The expected error of a method, and whether it is acceptable.

It is computed by `surrogate_validation.py` beside this file, on points drawn within the training volume.
"""

from dataclasses import dataclass
from math import hypot, isnan

LEAST_COVERAGE = 0.92
"""Least acceptable coverage of 95% ellipsoids; its standard deviation with a thousand points is 0.007."""
MOST_OVER_LIMIT = 2.0
"""Largest acceptable error, as a multiple of the noise limit."""


@dataclass(frozen=True)
class ExpectedError:
    """Errors of a method on points within the training volume, seen by the cameras of a surrogate.

    Attributes
    ----------
    rmse_mm : float
        Root mean square of the 3-D error; NaN where the method gives no points.
    limit_mm : float
        The same of cameras that are known exactly, by the pixels' noise.
    coverage95 : float
        Share of points within the 95% ellipsoid that the method states; 0 where it gives no covariance.
    adjustment_mm : float
        Root mean square of the errors that the adjustment of a hand-held target adds to all points, which
        are not in the figures above; 0 where a stage placed the target, NaN where it is not known.
    stage_mm : float
        The same of the errors of a stage's readings; 0 without a stage, NaN where they are not stated.
    """

    rmse_mm: float
    limit_mm: float
    coverage95: float
    adjustment_mm: float = 0.0
    stage_mm: float = 0.0

    @property
    def total_mm(self) -> float:
        """Root mean square of all errors, those of the adjustment included; NaN where these are not known.

        Errors of a stage are included where they are stated.
        """
        return hypot(self.rmse_mm, self.adjustment_mm, 0.0 if isnan(self.stage_mm) else self.stage_mm)

    @property
    def misfit(self) -> bool:
        """True if the errors are far above the noise limit or the stated covariance."""
        return self.too_large or not self.coverage95 >= LEAST_COVERAGE

    @property
    def too_large(self) -> bool:
        """True if the errors are far above the noise limit."""
        return not self.rmse_mm <= MOST_OVER_LIMIT * self.limit_mm  # of NaN, too
