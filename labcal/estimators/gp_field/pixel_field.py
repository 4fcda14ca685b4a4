"""A field of displacements given by measurements."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg
from jaxtyping import Float64

from labcal.estimators.gp_field.evidence import FieldScale


@dataclass(frozen=True)
class PixelField:
    """The mean of a Gaussian process given residuals, and its remaining variance.

    Rasmussen and Williams (2006), equations 2.25 and 2.26.

    Attributes
    ----------
    scale : FieldScale
    x : float64 array, (n, 3)
        Where it was measured.
    residual : float64 array, (n, 2)
        What was measured there, px.
    """

    scale: FieldScale
    x: Float64[np.ndarray, "n 3"]
    residual: Float64[np.ndarray, "n 2"]

    @cached_property
    def root(self) -> Float64[np.ndarray, "n n"]:
        """The Cholesky factor of the measurements' covariance, px."""
        return self.scale.root(self.x)

    def at(self, x: Float64[np.ndarray, "m 3"]) -> Float64[np.ndarray, "m 2"]:
        """Return the field, px."""
        return np.asarray(self.scale.kernel.between(x, self.x) @ self._weights)

    def slopes(self, x: Float64[np.ndarray, "m 3"]) -> Float64[np.ndarray, "m 2 3"]:
        """Return its derivatives by its inputs."""
        return self.scale.kernel.slopes(x, self.x, self._weights)

    def smoothed(self) -> Float64[np.ndarray, "n 2"]:
        """Return the field where it was measured, px."""
        return self.at(self.x)

    def reach(self, x: Float64[np.ndarray, "m 3"]) -> Float64[np.ndarray, "n m"]:
        """Return the covariance of the field at places with whitened measurements, px."""
        shared = self.scale.amplitude_px**2 * self.scale.kernel.between(self.x, x)
        return np.asarray(scipy.linalg.solve_triangular(self.root, shared, lower=True, check_finite=False))

    @cached_property
    def _weights(self) -> Float64[np.ndarray, "n 2"]:
        solved = scipy.linalg.cho_solve((self.root, True), self.residual, check_finite=False)
        return np.asarray(self.scale.amplitude_px**2 * solved)
