"""Linear regression of points on pixels."""

from typing import ClassVar

import numpy as np
from jaxtyping import Float64

from labcal.estimators.closed_form import ClosedFormEstimator
from labcal.estimators.estimator import FittedArray
from labcal.estimators.scaling import RangeScaling
from labcal.geometry.arrangement import refuse_collinear, refuse_few


class Affine(ClosedFormEstimator):
    """The method ``affine``: every output is a linear function of all image coordinates, and a constant.

    Exact for affine cameras. On data that leave a direction undetermined, such as a plane seen by affine
    cameras, the solution of least norm in scaled inputs is taken.

    Attributes
    ----------
    coefficients_ : float64 array, (1 + inputs, outputs)
        Constant first, for inputs scaled to [-1, 1].
    centre_, half_range_ : float64 array, (inputs,)
        The scaling of the inputs.
    """

    method: ClassVar[str] = "affine"

    def fitted_arrays(self) -> tuple[FittedArray, ...]:
        """Return the arrays that make up the fitted estimator."""
        return (
            FittedArray("coefficients_", (1 + self.n_features_in_, self.n_outputs_)),
            FittedArray("centre_", (self.n_features_in_,)),
            FittedArray("half_range_", (self.n_features_in_,)),
        )

    def _fit(self, pixels: Float64[np.ndarray, "n inputs"], points: Float64[np.ndarray, "n outputs"]) -> None:
        refuse_few(self.method, pixels, pixels.shape[1] + 1)
        if points.shape[1] >= 3:  # noqa: PLR2004 - X, Y, Z come first
            refuse_collinear(self.method, points[:, :3])
        scaling = RangeScaling.of(pixels)
        self.centre_, self.half_range_ = scaling.centre, scaling.half_range
        self.coefficients_ = np.linalg.lstsq(self._terms(pixels), points, rcond=1e-12)[0]

    def _predict(self, pixels: Float64[np.ndarray, "n inputs"]) -> Float64[np.ndarray, "n outputs"]:
        return np.asarray(self._terms(pixels) @ self.coefficients_)

    def _terms(self, pixels: Float64[np.ndarray, "n inputs"]) -> Float64[np.ndarray, "n terms"]:
        """Return the columns that are combined."""
        scaled = RangeScaling(self.centre_, self.half_range_).scaled(pixels)
        return np.column_stack((np.ones(len(scaled)), scaled))
