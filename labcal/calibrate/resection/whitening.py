"""How residuals in pixels are weighed against each other."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
import scipy.linalg
from jaxtyping import Float64


@runtime_checkable  # so that tests can check annotations
class Whitening(Protocol):
    """Turns pixel errors of n points into numbers of unit covariance."""

    def white(self, values: Float64[np.ndarray, "n *rest"]) -> Float64[np.ndarray, "n *rest"]:
        """Return values, px, along the axis of the points, in standard deviations."""


@dataclass(frozen=True)
class Even:
    """Every point has the same noise, and none knows of another's."""

    sigma_px: float = 1.0

    def white(self, values: Float64[np.ndarray, "n *rest"]) -> Float64[np.ndarray, "n *rest"]:
        """Return values, px, in standard deviations."""
        return np.asarray(values / self.sigma_px)


@dataclass(frozen=True)
class Correlated:
    """Errors of points that share a covariance, the same for both coordinates (generalised least squares).

    Attributes
    ----------
    root_px : float64 array, (n, n)
        The lower Cholesky factor of the covariance.
    """

    root_px: Float64[np.ndarray, "n n"]

    def white(self, values: Float64[np.ndarray, "n *rest"]) -> Float64[np.ndarray, "n *rest"]:
        """Return values, px, in independent standard deviations."""
        flat = scipy.linalg.solve_triangular(
            self.root_px, values.reshape(len(values), -1), lower=True, check_finite=False
        )
        return np.asarray(flat).reshape(values.shape)
