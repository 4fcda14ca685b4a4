"""The common part of methods that are fitted in closed form: they can afford to be fitted again."""

import numpy as np
from jaxtyping import Float64

from labcal.estimators.estimator import COORDINATES, FittedArray, PointEstimator
from labcal.estimators.held_out_errors import Predict, held_out_errors
from labcal.estimators.propagation import propagated_covariance
from labcal.estimators.scikit_learn import clone
from labcal.run.threads import one_blas_thread


class ClosedFormEstimator(PointEstimator):
    """A method whose covariance is the pixels' noise, and what it errs by besides on points held out.

    Errors on held-out points hold what the method cannot learn, how uncertain its parameters are, and the
    noise of the training pixels. The last is subtracted, as if it had been the noise of the pixels that are
    predicted, whose own noise is propagated: else noise would count twice.

    Attributes
    ----------
    residual_covariance_ : float64 array, (3, 3)
        Mean product of the errors of X, Y and Z on held-out training points, mm squared; of those on the
        training points themselves where there are too few to hold some out. Smaller with fewer outputs.
    noise_gain_ : float64 array, (3, 3)
        Mean covariance of X, Y and Z that uncorrelated noise of 1 px causes at the training pixels, mm/px
        squared.
    """

    def stored_arrays(self) -> tuple[FittedArray, ...]:
        """Return the arrays of the fitted estimator that are stored."""
        size = min(self.n_outputs_, COORDINATES)
        return (*super().stored_arrays(), FittedArray("noise_gain_", (size, size)))

    @one_blas_thread()
    def _residual_covariance(
        self, pixels: Float64[np.ndarray, "n inputs"], points: Float64[np.ndarray, "n outputs"]
    ) -> Float64[np.ndarray, "dim dim"]:
        trained = super()._residual_covariance(pixels, points)
        self.noise_gain_ = np.zeros_like(trained)
        if pixels.shape[1] % 2 == 0:  # else they are not those of cameras, and get no covariance
            unit = np.tile(np.eye(2), (len(pixels), pixels.shape[1] // 2, 1, 1))
            self.noise_gain_ = propagated_covariance(self._coordinates, pixels, unit).mean(axis=0)
        errors = held_out_errors(self._fitted_again, pixels, points)
        return self._mean_product(errors) if np.isfinite(errors).all() else trained

    def _fitted_again(self, pixels: np.ndarray, points: np.ndarray) -> Predict:
        """Return the predictions of a copy that is fitted to other points."""
        other: ClosedFormEstimator = clone(self)
        other.n_features_in_, other.n_outputs_ = pixels.shape[1], points.shape[1]
        other._fit(pixels, points)
        return other._predict

    def _covariance_parts(
        self,
        pixels: Float64[np.ndarray, "n inputs"],
        pixel_covariance: Float64[np.ndarray, "n cameras 2 2"],
    ) -> tuple[Float64[np.ndarray, "n dim dim"], Float64[np.ndarray, "n dim dim"]]:
        propagated = propagated_covariance(self._coordinates, pixels, pixel_covariance)
        variance = 0.5 * np.trace(pixel_covariance, axis1=2, axis2=3).mean(axis=1)
        noise = np.where(np.isfinite(variance), variance, 0.0)[:, None, None] * self.noise_gain_
        return propagated, _positive_part(self.residual_covariance_ - noise)


def _positive_part(covariance: Float64[np.ndarray, "n dim dim"]) -> Float64[np.ndarray, "n dim dim"]:
    """Return the nearest matrices without negative variances, in the sense of the sum of squares."""
    variance, axes = np.linalg.eigh(covariance)
    return np.asarray((axes * np.maximum(variance, 0.0)[:, None, :]) @ axes.mT)
