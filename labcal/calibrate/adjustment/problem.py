"""Bundle adjustment as a problem for the Levenberg-Marquardt loop: poses of views are eliminated."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.blocks import Blocks, Slopes, assemble
from labcal.calibrate.adjustment.datum_constraints import DatumConstraints
from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.prior_term import NO_PRIOR, LensPrior
from labcal.calibrate.adjustment.schur import Reduced
from labcal.calibrate.adjustment.state import Freedom, Layout, Lenses, RigState
from labcal.errors import InputError
from labcal.optim.robust import SQUARES, Loss

_UNDAMPED = 1e-13
"""Damping, in units of each parameter's own curvature, that only keeps rounding from a negative pivot."""
_POSE_STEPS = 2
"""Most Gauss-Newton steps of all poses after every step of everything."""
_SETTLED = 0.01
"""Share of the gain of a step of everything below which another step of the poses is not worth its time."""


@dataclass(frozen=True)
class AdjustmentProblem:
    """Make the weighted residuals of all observations small; a :class:`~labcal.optim.problem.Problem`.

    The cost is the sum of squared residuals in units of their variances, or what the loss makes of them.
    """

    observations: Observations
    freedom: Freedom
    loss: Loss = SQUARES
    prior: LensPrior = NO_PRIOR

    def cost(self, parameters: RigState) -> float:
        """Return the cost; infinite where a measured dot could not be imaged at all."""
        with np.errstate(invalid="ignore", over="ignore"):
            white = self.observations.whitener.whiten(parameters.residuals(self.observations).T)
            cost = float(self.loss.cost((white**2).sum(axis=0)).sum()) + self.prior.cost(parameters)
        return cost if np.isfinite(cost) else float("inf")

    def linearize(self, parameters: RigState) -> "ViewsEliminated":
        """Return the normal equations at a state."""
        layout = Layout(parameters, self.freedom)
        blocks = assemble(layout, self.observations, self.loss)
        datum = DatumConstraints.of(layout, self.observations)
        return ViewsEliminated(self, layout, datum.applied(self.prior.added(blocks, layout)), datum)


@dataclass(frozen=True)
class ViewsEliminated:
    """Normal equations at a state; a :class:`~labcal.optim.problem.Linearization`.

    Damping acts on what all views share; the views' poses follow it, by the linearised equations first.
    Then all poses take Gauss-Newton steps of their own while lenses and dots rest ("embedded iterations",
    Jeong et al. 2012). With a long focal length lens and poses trade against each other along a valley so
    curved that steps which are straight in all of them take hundreds.
    """

    problem: AdjustmentProblem
    layout: Layout
    blocks: Blocks
    datum: DatumConstraints

    @cached_property
    def reduced(self) -> Reduced | None:
        """The equations for what is shared; None where a view's dots do not fix its pose."""
        return Reduced.of(self.blocks)

    @property
    def gradient_norm(self) -> float:
        """Return |J'r| where J'J is the unit matrix: how many standard deviations off the minimum is.

        Its square is the decrease of the cost by a step without damping (the Newton decrement).
        """
        gradient = self.blocks.gradient
        step = None if self.reduced is None else self.reduced.solve(gradient, _UNDAMPED)
        if step is None:
            return float("inf")
        return float(np.sqrt(max(0.0, _gain(gradient, step))))

    def stepped(self, mu: float) -> RigState | None:
        """Return the state after a damped step, or None where it leads to no possible camera."""
        step = None if self.reduced is None else self.reduced.solve(self.blocks.gradient, mu)
        if step is None:
            return None
        try:
            state = self.layout.stepped(-step.shared, -step.view)
        except InputError:
            return None
        return self._settled(state, _gain(self.blocks.gradient, step))

    def shared_covariance(self) -> Float64[np.ndarray, "shared shared"]:
        """Return the covariance of all shared parameters; 0 for constrained, NaN for undetermined ones."""
        if self.reduced is None:
            return np.full_like(self.blocks.shared, np.nan)
        covariance = self.reduced.shared_covariance()
        covariance[self.datum.shared] = covariance[:, self.datum.shared] = 0.0
        return covariance

    def shared_spread(self) -> Float64[np.ndarray, "shared shared"]:
        """Return the same, with some very large variance for what the observations leave open."""
        if self.reduced is None:
            return np.full_like(self.blocks.shared, np.inf)
        spread = self.reduced.shared_spread()
        spread[self.datum.shared] = spread[:, self.datum.shared] = 0.0
        return spread

    def _settled(self, state: RigState, gain: float) -> RigState | None:
        """Return the state with all poses refined, of views and of cameras; lenses and dots are kept.

        `gain` is the predicted decrease of the cost by the whole step.
        """
        still = Freedom(Lenses.FIXED, self.layout.freedom.dots[:, :0])
        for _ in range(_POSE_STEPS):
            layout = Layout(state, still)
            blocks = assemble(layout, self.problem.observations, self.problem.loss)
            blocks = DatumConstraints.of(layout, self.problem.observations).applied(blocks)
            reduced = Reduced.of(blocks)
            step = None if reduced is None else reduced.solve(blocks.gradient, _UNDAMPED)
            if step is None or not np.isfinite(step.view).all():
                return None
            state = layout.stepped(-step.shared, -step.view)
            if _gain(blocks.gradient, step) < _SETTLED * gain:
                break
        return state


def _gain(gradient: Slopes, step: Slopes) -> float:
    """Return the decrease of the cost by a step of the linearised equations."""
    return float(gradient.shared @ step.shared + (gradient.view * step.view).sum())
