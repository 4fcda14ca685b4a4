"""Normal equations of a bundle adjustment, solved by the Schur complement over the views' poses."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg
from jaxtyping import Float64

from labcal.calibrate.adjustment.blocks import Blocks, Slopes

_OPEN = 1e-12
"""Share of the largest curvature below which a direction counts as not observed."""
_TAKES_PART = 1e-8
"""Squared share in such a direction from which on a parameter counts as open."""


@dataclass(frozen=True)
class Reduced:
    """Normal equations of the shared parameters after elimination of the poses of views.

    Triggs et al., "Bundle adjustment", 2000, section 6.1. Shared parameters are in units in which each by
    itself has a curvature of 1 *after* the views have followed: pixels of the principal point, of which
    nearly all is taken up by moving the targets, and lens coefficients are alike there.
    """

    inverse_root: Float64[np.ndarray, "views 6 6"]
    """Inverse of the lower Cholesky factor of every view's block."""
    reach: Float64[np.ndarray, "views 6 shared"]
    """The inverse root times the block that joins a view to what is shared."""
    scale: Float64[np.ndarray, " shared"]
    """Roots of the curvatures; 1 for what is not observed."""
    matrix: Float64[np.ndarray, "shared shared"]
    """Scaled."""

    @classmethod
    def of(cls, blocks: Blocks) -> "Reduced | None":
        """Return the reduced equations, or None if the dots of a view do not determine its pose."""
        try:
            inverse_root = np.linalg.inv(np.linalg.cholesky(blocks.view))
        except np.linalg.LinAlgError:
            return None
        reach = inverse_root @ blocks.cross.transpose(0, 2, 1)
        flat = reach.reshape(reach.shape[0] * reach.shape[1], -1)
        matrix = blocks.shared - flat.T @ flat
        curvature, before = np.diagonal(matrix), np.diagonal(blocks.shared)
        # Below this the difference is rounding.
        scale = np.sqrt(np.where(curvature > 1e-14 * before, curvature, np.maximum(1e-14 * before, 1e-300)))
        scale = np.where(before > 0.0, scale, 1.0)
        return cls(inverse_root, reach, scale, matrix / np.outer(scale, scale))

    def gradient(self, full: Slopes) -> Float64[np.ndarray, " shared"]:
        """Return the gradient for the shared parameters, scaled."""
        forward = np.einsum("vij,vj->vi", self.inverse_root, full.view)
        return np.asarray((full.shared - np.einsum("vki,vk->i", self.reach, forward)) / self.scale)

    def unscaled(
        self, full: Slopes
    ) -> tuple[Float64[np.ndarray, "shared shared"], Float64[np.ndarray, " shared"]]:
        """Return matrix and gradient for the shared parameters in their own units."""
        return self.matrix * np.outer(self.scale, self.scale), self.gradient(full) * self.scale

    def solve(self, full: Slopes, mu: float) -> Slopes | None:
        """Return x of (J'J + damping) x = full; damping `mu` acts on the shared parameters alone.

        None where the damped matrix is not positive definite.
        """
        damped = self.matrix + mu * np.eye(len(self.scale))
        try:
            root = np.linalg.cholesky(damped)
        except np.linalg.LinAlgError:
            return None
        shared = scipy.linalg.cho_solve((root, True), self.gradient(full)) / self.scale
        rest = np.einsum("vij,vj->vi", self.inverse_root, full.view) - self.reach @ shared
        return Slopes(shared, np.einsum("vji,vj->vi", self.inverse_root, rest))

    @cached_property
    def _spectrum(self) -> tuple[Float64[np.ndarray, " shared"], Float64[np.ndarray, "shared shared"]]:
        """Eigenvalues of the matrix, and its eigenvectors in columns."""
        curvature, axes = np.linalg.eigh(self.matrix)
        return curvature, axes

    def shared_spread(self) -> Float64[np.ndarray, "shared shared"]:
        """Return the covariance of all shared parameters; of what is not observed, some very large one."""
        curvature, axes = self._spectrum
        floor = _OPEN * curvature[-1:]
        return np.asarray((axes / np.maximum(curvature, floor)) @ axes.T / np.outer(self.scale, self.scale))

    def shared_covariance(self) -> Float64[np.ndarray, "shared shared"]:
        """Return the covariance of all shared parameters; NaN for those that the observations leave open."""
        covariance = self.shared_spread()
        curvature, axes = self._spectrum
        weak = curvature <= _OPEN * curvature[-1:]
        left_open = (axes[:, weak] ** 2).sum(axis=1) > _TAKES_PART
        covariance[left_open] = covariance[:, left_open] = np.nan
        return covariance
