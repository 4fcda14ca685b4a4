"""Error in pixels of a model that is linear in its parameters: of these, and of the terms that it lacks."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import PixelCovariances, Pixels

_INSIDE = 1e-6
"""Share of what is left of lacking terms, below which a fit takes them up."""
_CHANCE = 3.0
"""Standard deviations of a variance."""


@dataclass(frozen=True)
class Slopes:
    """Derivatives of predicted pixels by the parameters of a model, and by those of terms that it lacks.

    Attributes
    ----------
    by_parameter : float64 array, (n, 2, parameters)
        Px.
    by_lacking : float64 array, (n, 2, lacking)
        Px.
    """

    by_parameter: Float64[np.ndarray, "n 2 parameters"]
    by_lacking: Float64[np.ndarray, "n 2 lacking"]


@dataclass(frozen=True)
class LinearModelError:
    """The error of a least-squares fit of a model that is linear in its parameters.

    A fit errs by the noise that it was trained with, and by what it cannot express. The latter is described
    by the terms of the next degree, with independent coefficients of one variance, less what the fitted terms
    take up of them (by the alias matrix of Box and Wilson 1951). Both variances follow from the residuals:
    the noise from what is left where the lacking terms are fitted, too, and the coefficients from what these
    explain beyond the noise (Henderson 1953, method 3, of variance components).

    Attributes
    ----------
    gain : float64 array, (parameters, parameters)
        Covariance of the parameters by uncorrelated noise of 1 px.
    alias : float64 array, (parameters, lacking)
        Change of the fitted parameters by the coefficients of lacking terms.
    noise_px2 : float64
        Variance of each coordinate of a training pixel about the model with the lacking terms, px squared.
    noise_spread_px2 : float64
        Standard deviation of that variance, px squared.
    lacking_variance : float64
        Of the coefficients of the lacking terms.
    """

    gain: Float64[np.ndarray, "parameters parameters"]
    alias: Float64[np.ndarray, "parameters lacking"]
    noise_px2: float
    noise_spread_px2: float
    lacking_variance: float

    @classmethod
    def of(
        cls, residual: Pixels, response: Float64[np.ndarray, "n parameters 2"], slopes: Slopes
    ) -> "LinearModelError":
        """Return the error of a fit.

        Parameters
        ----------
        residual : float64 array, (n, 2)
            Predicted minus measured pixels of training.
        response : float64 array, (n, parameters, 2)
            Derivatives of the fitted parameters by training pixels, 1/px.
        slopes : Slopes
            At the training points.
        """
        gain = np.einsum("npx,nqx->pq", response, response, optimize=True)
        alias = np.einsum("npx,nxl->pl", response, slopes.by_lacking, optimize=True)
        left = slopes.by_lacking - slopes.by_parameter @ alias
        taken_up = np.einsum("nxp,npx->", slopes.by_parameter, response)
        smallest = _INSIDE * float(np.linalg.norm(slopes.by_lacking))
        variances = _variances(residual, left, smallest, residual.size - float(taken_up))
        return cls(gain, alias, *variances)

    def covariance(self, slopes: Slopes, measured: PixelCovariances) -> PixelCovariances:
        """Return the covariance of predicted minus exact pixels, (n, 2, 2), px squared.

        Parameters
        ----------
        slopes : Slopes
            At the points.
        measured : float64 array, (n, 2, 2)
            Covariance of the measured pixels. Where training pixels scattered by more than that, and by more
            than chance explains, the rest is taken for an error of the model, too.
        """
        by_parameter = slopes.by_parameter
        of_fit = self.noise_px2 * by_parameter @ self.gain @ by_parameter.mT
        left = slopes.by_lacking - by_parameter @ self.alias
        beyond = self.noise_px2 - 0.5 * np.trace(measured, axis1=1, axis2=2)
        beyond = np.where(beyond <= _CHANCE * self.noise_spread_px2, 0.0, beyond)
        of_model = self.lacking_variance * left @ left.mT + beyond[:, None, None] * np.eye(2)
        return np.asarray(of_fit + of_model)


def _variances(
    residual: Pixels, left: Float64[np.ndarray, "n 2 lacking"], smallest: float, freedom: float
) -> tuple[float, float, float]:
    """Return the variance of noise, its standard deviation, and the variance of lacking coefficients.

    All by the moments of residuals; what lacking terms leave counts from a `smallest` singular value on.
    Where the residuals are too few to tell noise from lacking terms, all of them count as noise.
    """
    flat, total = left.reshape(residual.size, -1), float((residual**2).sum())
    directions, size, _ = np.linalg.svd(flat, full_matrices=False)
    kept = directions[:, size > smallest]
    explained = float(((kept.T @ residual.ravel()) ** 2).sum())
    rest = freedom - kept.shape[1]
    if rest < 1.0:
        return total / max(freedom, 1.0), total, 0.0
    noise = max(total - explained, 0.0) / rest
    beyond = explained - noise * kept.shape[1]
    lacking = beyond / float((size**2).sum()) if beyond > 0.0 else 0.0
    return noise, noise * float(np.sqrt(2.0 / rest)), lacking
