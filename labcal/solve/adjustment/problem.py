"""Bundle adjustment as a problem for the Levenberg-Marquardt loop: poses of views are eliminated."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg
from jaxtyping import Float64

from labcal.errors import InputError
from labcal.optim.robust import SQUARES, Loss
from labcal.solve.adjustment.blocks import Blocks, assemble
from labcal.solve.adjustment.observations import Observations
from labcal.solve.adjustment.state import Freedom, Layout, RigState

_UNDAMPED = 1e-13
"""Damping, in units of each parameter's own curvature, that only keeps rounding from a negative pivot."""
_OPEN = 1e-12
"""Share of the largest curvature below which a direction counts as not observed."""
_TAKES_PART = 1e-8
"""Squared share in such a direction from which on a parameter counts as open."""


@dataclass(frozen=True)
class AdjustmentProblem:
    """Make the weighted residuals of all observations small; a :class:`~labcal.optim.problem.Problem`.

    The cost is the sum of squared residuals in units of their variances, or what the loss makes of them.
    """

    observations: Observations
    freedom: Freedom
    loss: Loss = SQUARES

    def cost(self, parameters: RigState) -> float:
        """Return the cost; infinite where a measured dot could not be imaged at all."""
        with np.errstate(invalid="ignore", over="ignore"):
            residual = parameters.residuals(self.observations)
            white = np.einsum("nij,nj->ni", self.observations.whitener, residual)
            cost = float(self.loss.cost((white**2).sum(axis=1)).sum())
        return cost if np.isfinite(cost) else float("inf")

    def linearize(self, parameters: RigState) -> "ViewsEliminated":
        """Return the normal equations at a state."""
        layout = Layout(parameters, self.freedom)
        return ViewsEliminated(layout, assemble(layout, self.observations, self.loss))


@dataclass(frozen=True)
class _Step:
    shared: Float64[np.ndarray, " shared"]
    views: Float64[np.ndarray, "views 6"]


@dataclass(frozen=True)
class ViewsEliminated:
    """Normal equations solved by the Schur complement over the views' poses.

    Damping acts in units of each parameter's own curvature (Marquardt 1963), so that millimetres, radians
    and lens coefficients are alike. Triggs et al., "Bundle adjustment", 2000, section 6.1.
    """

    layout: Layout
    blocks: Blocks

    @property
    def gradient_norm(self) -> float:
        """Return |J'r| where J'J is the unit matrix: how many standard deviations off the minimum is.

        Its square is what a step without damping would take off the cost (the Newton decrement).
        """
        step = self._solved(_UNDAMPED)
        if step is None:
            return float("inf")
        gain = self.blocks.shared_gradient @ step.shared + (self.blocks.view_gradient * step.views).sum()
        return float(np.sqrt(max(0.0, -gain)))

    def stepped(self, mu: float) -> RigState | None:
        """Return the state after a damped step, or None where it leads to no possible camera."""
        step = self._solved(mu)
        if step is None:
            return None
        try:
            return self.layout.stepped(step.shared, step.views)
        except InputError:
            return None

    def shared_covariance(self) -> Float64[np.ndarray, "shared shared"]:
        """Return the covariance of all shared parameters; NaN for those that the observations leave open."""
        d, _ = self._scales
        factors = self._factors(_UNDAMPED)
        if factors is None:
            return np.full_like(self.blocks.shared, np.nan)
        curvature, axes = np.linalg.eigh(factors.reduced)
        weak = curvature <= _OPEN * curvature[-1:]
        strong = axes[:, ~weak]
        covariance: np.ndarray = (strong / curvature[~weak]) @ strong.T / np.outer(d, d)
        left_open = (axes[:, weak] ** 2).sum(axis=1) > _TAKES_PART
        covariance[left_open] = covariance[:, left_open] = np.nan
        return covariance

    @cached_property
    def _scales(self) -> tuple[np.ndarray, np.ndarray]:
        """Roots of the curvatures; 1 for what is not observed."""
        d = np.sqrt(np.diagonal(self.blocks.shared))
        e = np.sqrt(np.diagonal(self.blocks.view, axis1=1, axis2=2))
        return np.where(d > 0, d, 1.0), np.where(e > 0, e, 1.0)

    def _factors(self, mu: float) -> "_Factors | None":
        d, e = self._scales
        shared = self.blocks.shared / np.outer(d, d) + mu * np.eye(len(d))
        cross = self.blocks.cross / (d[:, None] * e[:, None, :])
        view = self.blocks.view / (e[:, :, None] * e[:, None, :]) + mu * np.eye(e.shape[1])
        try:
            root = np.linalg.cholesky(view)
            # L^-1 E': one triangular system a view, small enough to invert.
            reach = np.linalg.inv(root) @ cross.transpose(0, 2, 1)
            flat = reach.reshape(-1, len(d))
            reduced = shared - flat.T @ flat
            reduced_root = np.linalg.cholesky(reduced)
        except np.linalg.LinAlgError:
            return None
        return _Factors(root, reach, reduced, reduced_root)

    def _solved(self, mu: float) -> _Step | None:
        """Return the step that solves the damped normal equations, or None where they are not definite."""
        factors = self._factors(mu)
        if factors is None:
            return None
        d, e = self._scales
        g, h = self.blocks.shared_gradient / d, self.blocks.view_gradient / e
        forward = np.linalg.solve(factors.root, h[:, :, None])[:, :, 0]
        right = g - np.einsum("vki,vk->i", factors.reach, forward)
        shared = -scipy.linalg.cho_solve((factors.reduced_root, True), right)
        rest = -forward - factors.reach @ shared
        views = np.linalg.solve(factors.root.transpose(0, 2, 1), rest[:, :, None])[:, :, 0]
        return _Step(shared / d, views / e)


@dataclass(frozen=True)
class _Factors:
    """Scaled and damped normal equations, factored."""

    root: Float64[np.ndarray, "views 6 6"]
    """Lower Cholesky factor of every view's block."""
    reach: Float64[np.ndarray, "views 6 shared"]
    """The inverse root times the block that joins a view to what is shared."""
    reduced: Float64[np.ndarray, "shared shared"]
    reduced_root: Float64[np.ndarray, "shared shared"]
