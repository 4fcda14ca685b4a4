"""Residuals in units of their standard deviations."""

from dataclasses import dataclass

import numpy as np
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
