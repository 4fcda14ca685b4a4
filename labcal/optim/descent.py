"""The course of one optimisation: where it is, how strongly it is damped, and why it stopped."""

import math
from dataclasses import dataclass, field
from typing import Generic

import numpy as np

from labcal.optim.damping import Damping
from labcal.optim.problem import Parameters
from labcal.optim.solution import History, Solution, Stopping, StopReason


@dataclass
class Descent(Generic[Parameters]):
    """One run; the loop tells it what it met, and it decides.

    Attributes
    ----------
    parameters : Parameters
        The best so far.
    cost : float
        Their cost.
    stopping : Stopping
        When to stop.
    damping : Damping
        How damping changes.
    mu : float
        The damping to try next.
    reason : StopReason or None
        Why it stopped; None while it runs.
    is_stepping : bool
        Whether a step from the present linearisation is still to be found.
    """

    parameters: Parameters
    cost: float
    stopping: Stopping
    damping: Damping
    mu: float = field(init=False)
    reason: StopReason | None = field(init=False, default=None)
    is_stepping: bool = field(init=False, default=False)

    def __post_init__(self) -> None:
        """Begin; what is at its goal already has stopped."""
        self.mu = self.damping.start
        self._costs, self._dampings = [self.cost], [self.mu]
        self._look_at_cost()

    @property
    def epochs(self) -> int:
        """The number of accepted steps."""
        return len(self._costs) - 1

    def restate(self, cost: float) -> None:
        """Take another cost for the present parameters, where what they cost has changed."""
        self.cost = self._costs[-1] = cost
        if not math.isfinite(cost):
            self.reason = StopReason.NOT_FINITE

    def stop(self, reason: StopReason) -> None:
        """Stop where it is."""
        self.reason = reason

    def begin_step(self, gradient_norm: float) -> None:
        """Set out from a linearisation at the present parameters, unless it has stopped or need not."""
        if self.reason is not None:
            return
        if gradient_norm <= self.stopping.min_gradient:
            self.reason = StopReason.GRADIENT
        else:
            self.is_stepping = True
            self._look_at_damping()

    def consider(self, candidate: Parameters, cost: float) -> None:
        """Go to a candidate if it lowers the cost, which ends the step; NaN does not."""
        if not cost < self.cost:
            return
        self.parameters, self.cost = candidate, cost
        self.mu = self.damping.after_success(self.mu)
        self._costs.append(cost)
        self._dampings.append(self.mu)
        self.is_stepping = False
        self._look_at_cost()

    def damp(self) -> None:
        """Raise the damping after a step that did not help."""
        self.mu = self.damping.after_failure(self.mu)
        self._look_at_damping()

    def solution(self) -> Solution[Parameters]:
        """Return where it ended; to be asked for once there is a reason."""
        history = History(np.array(self._costs), np.array(self._dampings))
        reason = self.reason or StopReason.EPOCHS
        return Solution(self.parameters, self.cost, reason, self.epochs, self.mu, history)

    def _look_at_cost(self) -> None:
        if not math.isfinite(self.cost):
            self.reason = StopReason.NOT_FINITE
        elif self.cost <= self.stopping.goal:
            self.reason = StopReason.GOAL
        elif self.epochs >= self.stopping.max_epochs:
            self.reason = StopReason.EPOCHS

    def _look_at_damping(self) -> None:
        if not self.mu <= self.damping.ceiling:
            self.reason, self.is_stepping = StopReason.CEILING, False
