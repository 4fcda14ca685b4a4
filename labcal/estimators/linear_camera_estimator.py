"""The common part of methods with a model of each camera that is linear in its parameters."""

from abc import abstractmethod
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels, Vectors3
from labcal.estimators.estimator import FittedArray, PointEstimator
from labcal.estimators.linear_model_error import LinearModelError, Slopes
from labcal.estimators.propagation import propagated_covariances
from labcal.run.threads import one_blas_thread

AT_ONCE = 500
"""Points whose derivatives by all parameters are held at once."""


class LinearCameraEstimator(PointEstimator):
    """A method that knows from its own residuals, by place, what each of its cameras may be off by.

    The covariance of a point is that of its pixels, propagated. To the noise of the pixels of each camera is
    added what the camera's model may be off by at that place, in pixels; see `LinearModelError`.

    Attributes
    ----------
    gain_ : float64 array, (cameras, parameters, parameters)
        As in `LinearModelError`; zeros where a camera has fewer parameters than another.
    alias_ : float64 array, (cameras, parameters, lacking)
        As in `LinearModelError`; zeros where fewer terms are lacking.
    variances_ : float64 array, (cameras, 3)
        Of the noise of training, px squared, with its standard deviation, and of the coefficients of lacking
        terms.
    """

    def stored_arrays(self) -> tuple[FittedArray, ...]:
        """Return the arrays of the fitted estimator that are stored."""
        cameras = self.n_features_in_ // 2
        parameters, lacking = self._sizes()
        return (
            *super().stored_arrays(),
            FittedArray("gain_", (cameras, parameters, parameters)),
            FittedArray("alias_", (cameras, parameters, lacking)),
            FittedArray("variances_", (cameras, 3)),
        )

    @abstractmethod
    def _sizes(self) -> tuple[int, int]:
        """Return the largest numbers of parameters and of lacking terms of a camera."""

    @abstractmethod
    def _slopes(self, camera: int, q: Pixels, p: Vectors3) -> Slopes:
        """Return derivatives of predicted pixels at pixels (n, 2) that see points, mm."""

    def _keep_errors(self, errors: Sequence[LinearModelError]) -> None:
        """Store the errors of all cameras; where there are none there is nothing that they are off by."""
        parameters, lacking = self._sizes()
        self.gain_ = np.zeros((len(errors), parameters, parameters))
        self.alias_ = np.zeros((len(errors), parameters, lacking))
        self.variances_ = np.array(
            [(one.noise_px2, one.noise_spread_px2, one.lacking_variance) for one in errors]
        )
        for camera, one in enumerate(errors):
            own, left_out = one.alias.shape
            self.gain_[camera, :own, :own] = one.gain
            self.alias_[camera, :own, :left_out] = one.alias

    def _covariance_parts(
        self,
        pixels: Float64[np.ndarray, "n inputs"],
        pixel_covariance: Float64[np.ndarray, "n cameras 2 2"],
    ) -> tuple[Float64[np.ndarray, "n dim dim"], Float64[np.ndarray, "n dim dim"]]:
        p = self._predict(pixels)
        own = np.empty_like(pixel_covariance)
        with one_blas_thread(), np.errstate(all="ignore"):  # of points that are nowhere
            for first in range(0, len(pixels), AT_ONCE):
                rows = slice(first, first + AT_ONCE)
                for camera in range(pixel_covariance.shape[1]):
                    q = pixels[rows, 2 * camera : 2 * camera + 2]
                    slopes = self._slopes(camera, q, p[rows])
                    error = self._error(camera, slopes)
                    own[rows, camera] = error.covariance(slopes, pixel_covariance[rows, camera])
        of_noise, of_model = propagated_covariances(self._coordinates, pixels, pixel_covariance, own)
        return of_noise, of_model

    def _error(self, camera: int, slopes: Slopes) -> LinearModelError:
        """Return the error of a camera."""
        own, left_out = slopes.by_parameter.shape[2], slopes.by_lacking.shape[2]
        gain, alias = self.gain_[camera, :own, :own], self.alias_[camera, :own, :left_out]
        return LinearModelError(gain, alias, *self.variances_[camera].tolist())
