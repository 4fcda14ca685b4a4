"""Regression of points on pixels and all their products of second degree."""

from typing import ClassVar

import numpy as np
from jaxtyping import Float64

from labcal.estimators.closed_form import ClosedFormEstimator
from labcal.estimators.estimator import FittedArray
from labcal.estimators.scaling import RangeScaling
from labcal.geometry.arrangement import refuse_collinear, refuse_few


class Quadratic(ClosedFormEstimator):
    """The method ``quadratic``: `affine` with all terms of second degree.

    On a plane one camera's coordinates follow from the other's, so that the terms are nearly dependent:
    directions weaker than 1e-10 of the strongest are left out (least norm).

    Attributes
    ----------
    coefficients_ : float64 array, (terms, outputs)
        Constant, linear terms, then the products (i, j) with i <= j, for inputs scaled to [-1, 1].
    centre_, half_range_ : float64 array, (inputs,)
        The scaling of the inputs.
    """

    method: ClassVar[str] = "quadratic"

    def fitted_arrays(self) -> tuple[FittedArray, ...]:
        """Return the arrays that make up the fitted estimator."""
        return (
            FittedArray("coefficients_", (_term_count(self.n_features_in_), self.n_outputs_)),
            FittedArray("centre_", (self.n_features_in_,)),
            FittedArray("half_range_", (self.n_features_in_,)),
        )

    def _fit(self, pixels: Float64[np.ndarray, "n inputs"], points: Float64[np.ndarray, "n outputs"]) -> None:
        refuse_few(self.method, pixels, _term_count(pixels.shape[1]))
        if points.shape[1] >= 3:  # noqa: PLR2004 - X, Y, Z come first
            refuse_collinear(self.method, points[:, :3])
        scaling = RangeScaling.of(pixels)
        self.centre_, self.half_range_ = scaling.centre, scaling.half_range
        self.coefficients_ = np.linalg.lstsq(self._terms(pixels), points, rcond=1e-10)[0]

    def _predict(self, pixels: Float64[np.ndarray, "n inputs"]) -> Float64[np.ndarray, "n outputs"]:
        return np.asarray(self._terms(pixels) @ self.coefficients_)

    def _terms(self, pixels: Float64[np.ndarray, "n inputs"]) -> Float64[np.ndarray, "n terms"]:
        """Return the columns that are combined."""
        scaled = RangeScaling(self.centre_, self.half_range_).scaled(pixels)
        first, second = np.triu_indices(scaled.shape[1])
        return np.column_stack((np.ones(len(scaled)), scaled, scaled[:, first] * scaled[:, second]))


def _term_count(inputs: int) -> int:
    """Return the number of terms up to the second degree."""
    return (inputs + 1) * (inputs + 2) // 2
