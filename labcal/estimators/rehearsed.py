"""What a rehearsal tells of a method: whether to trust it."""

from dataclasses import dataclass

LEAST_COVERAGE = 0.92
"""A method whose 95% ellipsoids hold fewer is wrong by more than it says; a thousand points scatter by
0.007."""
MOST_OVER_LIMIT = 2.0
"""A method that errs by more than so many times what the noise leaves does not fit the cameras."""


@dataclass(frozen=True)
class Rehearsed:
    """How a method did on points within the trained volume, seen by the twin's cameras.

    Attributes
    ----------
    rmse_mm : float
        Root mean square of the 3-D error; NaN where the method gives no points.
    limit_mm : float
        The same of cameras that are known exactly, by the pixels' noise.
    coverage95 : float
        Share of points within the 95% ellipsoid that the method states; 0 where it gives no covariance.
    """

    rmse_mm: float
    limit_mm: float
    coverage95: float

    @property
    def misfit(self) -> bool:
        """Whether the method errs by far more than the noise leaves, or by more than it says."""
        return self.too_large or not self.coverage95 >= LEAST_COVERAGE

    @property
    def too_large(self) -> bool:
        """Whether it errs by far more than the noise leaves."""
        return not self.rmse_mm <= MOST_OVER_LIMIT * self.limit_mm  # of NaN, too
