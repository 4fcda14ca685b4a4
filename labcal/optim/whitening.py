"""Residuals in units of their standard deviations, so that a sum of their squares is a chi-square.

Three kinds: pixels with a covariance each (:class:`Whitener`), points with one variance
(:class:`UniformNoise`), and points whose errors are correlated (:class:`CorrelatedNoise`).
"""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
import scipy.linalg
from jaxtyping import Float64


@dataclass(frozen=True)
class Whitener:
    """For each of n pixels the lower triangular matrix that makes its covariance the unit matrix.

    It is the inverse of the covariance's Cholesky factor, in closed form; each element of the matrix is an
    array over the pixels, so that all pixels are computed at once.
    """

    uu: Float64[np.ndarray, " n"]
    vu: Float64[np.ndarray, " n"]
    vv: Float64[np.ndarray, " n"]

    @classmethod
    def of(cls, covariance: Float64[np.ndarray, "n 2 2"]) -> "Whitener":
        """Return the whitener of covariances (px squared), all of them positive definite."""
        uu = 1.0 / np.sqrt(covariance[:, 0, 0])
        along = covariance[:, 1, 0] * uu
        vv = 1.0 / np.sqrt(covariance[:, 1, 1] - along**2)
        return cls(uu, -along * uu * vv, vv)

    def rows(self, rows: slice) -> "Whitener":
        """Return the whitener of some of the pixels."""
        return Whitener(self.uu[rows], self.vu[rows], self.vv[rows])

    def weighted(self, weight: Float64[np.ndarray, " n"]) -> "Whitener":
        """Return the whitener with each pixel weighted."""
        return Whitener(weight * self.uu, weight * self.vu, weight * self.vv)

    def whiten(self, values: Float64[np.ndarray, "*columns 2 n"]) -> Float64[np.ndarray, "*columns 2 n"]:
        """Return values along u and v (px, or per anything) in standard deviations."""
        whitened = np.empty(values.shape)
        np.multiply(self.uu, values[..., 0, :], out=whitened[..., 0, :])
        np.multiply(self.vv, values[..., 1, :], out=whitened[..., 1, :])
        whitened[..., 1, :] += self.vu * values[..., 0, :]
        return whitened


@runtime_checkable  # so that tests can check annotations
class Whitening(Protocol):
    """A map from pixel errors of n points to values of unit covariance."""

    def whiten(self, values: Float64[np.ndarray, "n *rest"]) -> Float64[np.ndarray, "n *rest"]:
        """Return values, px, along the axis of the points, in standard deviations."""


@dataclass(frozen=True)
class UniformNoise:
    """The same independent noise at every point."""

    sigma_px: float = 1.0

    def whiten(self, values: Float64[np.ndarray, "n *rest"]) -> Float64[np.ndarray, "n *rest"]:
        """Return values, px, in standard deviations."""
        return np.asarray(values / self.sigma_px)


@dataclass(frozen=True)
class CorrelatedNoise:
    """Errors of points that share a covariance, the same for both coordinates (generalised least squares).

    Attributes
    ----------
    root_px : float64 array, (n, n)
        The lower Cholesky factor of the covariance.
    """

    root_px: Float64[np.ndarray, "n n"]

    def whiten(self, values: Float64[np.ndarray, "n *rest"]) -> Float64[np.ndarray, "n *rest"]:
        """Return values, px, in independent standard deviations."""
        flat = scipy.linalg.solve_triangular(
            self.root_px, values.reshape(len(values), -1), lower=True, check_finite=False
        )
        return np.asarray(flat).reshape(values.shape)
