"""The scale that known distances give, and how well they agree."""

from dataclasses import dataclass
from math import sqrt

from labcal.distributions import chi2_upper_quantile
from labcal.wording import clipped, counted, printable

UNLIKELY = 1e-3
"""Probability of residuals as large by the covariances alone, below which a warning is due."""


@dataclass(frozen=True)
class BarResidual:
    """A scale bar in a view."""

    view: str
    one: str
    other: str
    stated_mm: float
    measured_mm: float
    """By the cameras as they were calibrated."""
    adjusted_mm: float
    """After all bars entered."""
    sigma_mm: float
    """Standard deviation of `measured_mm` minus `stated_mm`, but for the scale."""


@dataclass(frozen=True)
class FittedScale:
    """Result of the adjustment to scale bars."""

    error_ppm: float
    """Error of the scale that was found and removed; above 0 where lengths had been measured too long."""
    sigma_ppm: float
    """Standard deviation of the scale afterwards."""
    chi_square: float
    """Least sum of squares of what bars correct, in standard deviations of lengths, pixels and cameras."""
    freedom: int
    """Its degrees of freedom: one less than bars, if nothing is known of the scale beforehand."""
    bars: tuple[BarResidual, ...]

    @property
    def sigma0(self) -> float | None:
        """Root of chi-square over its degrees of freedom; None where none are left."""
        return sqrt(self.chi_square / self.freedom) if self.freedom else None

    @property
    def warnings(self) -> tuple[str, ...]:
        """A warning where bars contradict each other, or the calibration."""
        if not self.freedom or self.chi_square <= chi2_upper_quantile(UNLIKELY, self.freedom):
            return ()
        worst = max(self.bars, key=lambda bar: abs(bar.adjusted_mm - bar.stated_mm))
        warning = (
            f"{counted(len(self.bars), 'measurement')} of scale bars lie {self.sigma0:.2g} times as far off "
            "as noise, calibration and the bars' own sigmas explain: a length is wrong, points are confused, "
            "or a camera has changed. The largest residual is left between "
            f"'{clipped(printable(worst.one))}' and '{clipped(printable(worst.other))}' in view "
            f"'{clipped(printable(worst.view))}': {worst.adjusted_mm - worst.stated_mm:+.3g} mm."
        )
        return (warning,)
