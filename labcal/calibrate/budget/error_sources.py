"""The sources of a calibration's errors, found from its residuals, and the covariance that they make."""

from dataclasses import dataclass
from math import hypot

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.rounds import Adjusted
from labcal.calibrate.adjustment.state import Lenses
from labcal.calibrate.budget.correlated_errors import CorrelatedErrors
from labcal.calibrate.budget.entered import Entered
from labcal.calibrate.budget.omitted_lens import omitted_errors
from labcal.calibrate.budget.print_share import PrintShare
from labcal.calibrate.budget.view_dispersion import ViewDispersion
from labcal.calibrate.freed_dots import FreedDots
from labcal.targets.places import DotPlaces


@dataclass(frozen=True)
class ErrorSources:
    """Sizes of the errors of pixels, views and print.

    Attributes
    ----------
    views : ViewDispersion
    print_share : PrintShare or None
        None where nothing was estimated, as of lenses that were kept.

    prior : float64 array, (cameras,)
        Inverse variances of the prior of lens coefficients by parameter, 0 elsewhere.
    omitted : float64 array, (cameras, omitted)
        Errors of parameters by coefficients that the lenses do not have, one sigma each.
    correlated : CorrelatedErrors or None
        Errors that dots of a view share, where views disagree beyond chance; None where they do not.
    """

    views: ViewDispersion
    print_share: PrintShare | None
    prior: Float64[np.ndarray, " cameras"]
    omitted: Float64[np.ndarray, "cameras omitted"]
    correlated: CorrelatedErrors | None = None

    @classmethod
    def of(
        cls,
        adjusted: Adjusted,
        observations: Observations,
        freed: FreedDots | None,
        known: DotPlaces | None = None,
    ) -> "ErrorSources":
        """Return the sources of the errors of an adjustment.

        Parameters
        ----------
        adjusted : Adjusted
        observations : Observations
            Centroids as measured; all that the adjustment was given.
        freed : FreedDots or None
            The dots where they were freed.
        known : DotPlaces or None
            The dots where they were measured before, and kept there.
        """
        entered = Entered.of(adjusted, observations)
        fixed = adjusted.layout.freedom.lenses is Lenses.FIXED
        if fixed or entered.with_fixed_dots().reduced is None:
            nothing = np.zeros(entered.cameras)
            return cls(ViewDispersion(1.0, 0.0), None, nothing, nothing[:, None][:, :0])
        if freed is None:
            share = PrintShare.of_declared(entered, known)
        else:
            share = PrintShare.of_freed(entered, freed)
        views = ViewDispersion.of(entered, share.residual)
        omitted = omitted_errors(entered, share.noise * views.factor)
        correlated = CorrelatedErrors.of(entered) if views.is_beyond_chance else None
        return cls(views, share, entered.prior_by_parameter(), omitted, correlated)

    @property
    def noise_factor(self) -> float:
        """Variance of residuals without the print's share, over the one that is stated."""
        return 1.0 if self.print_share is None else self.print_share.noise

    @property
    def print_sigma_mm(self) -> float:
        """Standard deviation of dots on the print along each direction of its plane, mm."""
        share = self.print_share
        return 0.0 if share is None else hypot(share.sigma_mm, share.measured_sigma_mm)

    def total(
        self, cameras: Float64[np.ndarray, "cameras cameras"]
    ) -> Float64[np.ndarray, "cameras cameras"]:
        """Return the covariance of the lens models' own parameters, of the one that noise and prior make.

        Notes
        -----
        Of C = (H + P)^-1 with the information H of the dots and P of the prior, the factors are of the dots'
        errors alone: C (f H + P) C = f C + (1 - f) C P C. The print adds its own.
        """
        if self.print_share is None:
            return cameras
        factor, beside = self.noise_factor * self.views.factor, self.print_share.covariance
        if self.correlated is not None:
            independent = self.noise_factor / self.print_share.residual
            factor, beside = independent * self.correlated.white, beside + self.correlated.covariance
        by_prior = (cameras * self.prior) @ cameras
        return np.asarray(factor * cameras + (1.0 - factor) * by_prior + beside)

    def with_omitted(
        self, cameras: Float64[np.ndarray, "cameras cameras"]
    ) -> Float64[np.ndarray, "cameras cameras"]:
        """Return :meth:`total` and the share of coefficients that the lenses do not have.

        What a rig does to points: its parameters as those of lenses which real ones are not quite.
        """
        return np.asarray(self.total(cameras) + self.omitted @ self.omitted.T)
