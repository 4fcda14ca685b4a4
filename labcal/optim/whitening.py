"""Residuals in units of their standard deviations, so that a sum of their squares is a chi-square.

Of pixels with covariances of their own each (:class:`Whitener`), of points with one noise (:class:`Even`),
and of points whose errors are correlated (:class:`Correlated`).
"""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
import scipy.linalg
from jaxtyping import Float64


@dataclass(frozen=True)
class Whitener:
    """For each of n pixels the lower triangular matrix that makes its covariance the unit matrix.

    It is the inverse of the covariance's Cholesky factor, in closed form; numbers of one place of the matrix
    stand together, so that all pixels are treated at once.
    """

    uu: Float64[np.ndarray, " n"]
    vu: Float64[np.ndarray, " n"]
    vv: Float64[np.ndarray, " n"]

    @classmethod
    def of(cls, covariance: Float64[np.ndarray, "n 2 2"]) -> "Whitener":
        """Return that of covariances (px squared), all of them positive definite."""
        uu = 1.0 / np.sqrt(covariance[:, 0, 0])
        along = covariance[:, 1, 0] * uu
        vv = 1.0 / np.sqrt(covariance[:, 1, 1] - along**2)
        return cls(uu, -along * uu * vv, vv)

    def rows(self, rows: slice) -> "Whitener":
        """Return that of some of the pixels."""
        return Whitener(self.uu[rows], self.vu[rows], self.vv[rows])

    def times(self, weight: Float64[np.ndarray, " n"]) -> "Whitener":
        """Return it with each pixel weighted."""
        return Whitener(weight * self.uu, weight * self.vu, weight * self.vv)

    def applied(self, values: Float64[np.ndarray, "*columns 2 n"]) -> Float64[np.ndarray, "*columns 2 n"]:
        """Return values along u and v (px, or per anything) in standard deviations."""
        whitened = np.empty(values.shape)
        np.multiply(self.uu, values[..., 0, :], out=whitened[..., 0, :])
        np.multiply(self.vv, values[..., 1, :], out=whitened[..., 1, :])
        whitened[..., 1, :] += self.vu * values[..., 0, :]
        return whitened


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
