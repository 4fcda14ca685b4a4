"""The state of one Levenberg-Marquardt minimisation: parameters, cost, damping and stop reason."""

import math
from dataclasses import dataclass, field
from typing import Generic

import numpy as np

from labcal.optim.damping import Damping
from labcal.optim.problem import Parameters
from labcal.optim.solution import History, Solution
from labcal.optim.stopping import Stopping, StopReason


@dataclass
class LevenbergMarquardtState(Generic[Parameters]):
    """The state of one run; the loop reports each candidate to it, and it accepts or rejects.

    Attributes
    ----------
    parameters : Parameters
        Those with the lowest cost so far.
    cost : float
        Their cost.
    stopping : Stopping
        Conditions under which it stops.
    damping : Damping
        The rule by which damping changes.
    mu : float
        The damping to try next.
    reason : StopReason or None
        The reason why it stopped; None while it runs.
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
        """Set the initial damping, and stop a run that is at its goal already."""
        self.mu = self.damping.start
        self._costs, self._dampings = [self.cost], [self.mu]
        self.reason = self.stopping.reason(self.cost, self.epochs)

    @property
    def epochs(self) -> int:
        """The number of accepted steps."""
        return len(self._costs) - 1

    def set_cost(self, cost: float) -> None:
        """Replace the cost of the present parameters, after the cost function has changed."""
        self.cost = self._costs[-1] = cost
        if not math.isfinite(cost):
            self.reason = StopReason.NOT_FINITE

    def stop(self, reason: StopReason) -> None:
        """Stop at the present parameters."""
        self.reason = reason

    def begin_step(self, gradient_norm: float) -> None:
        """Begin a step from a linearisation, unless the run has stopped or its gradient is small enough."""
        if self.reason is not None:
            return
        self.reason = self.stopping.reason_of_gradient(gradient_norm)
        if self.reason is None:
            self.is_stepping = True
            self._check_damping()

    def accept_if_lower(self, candidate: Parameters, cost: float) -> None:
        """Accept a candidate if it lowers the cost, which ends the step; a cost of NaN does not."""
        if not cost < self.cost:
            return
        self.parameters, self.cost = candidate, cost
        self.mu = self.damping.after_success(self.mu)
        self._costs.append(cost)
        self._dampings.append(self.mu)
        self.is_stepping = False
        self.reason = self.stopping.reason(self.cost, self.epochs)

    def raise_damping(self) -> None:
        """Raise the damping after a step that did not lower the cost."""
        self.mu = self.damping.after_failure(self.mu)
        self._check_damping()

    def solution(self) -> Solution[Parameters]:
        """Return the result; call it only after the run has stopped."""
        history = History(np.array(self._costs), np.array(self._dampings))
        reason = self.reason or StopReason.EPOCHS
        return Solution(self.parameters, self.cost, reason, self.epochs, self.mu, history)

    def _check_damping(self) -> None:
        if not self.mu <= self.damping.ceiling:
            self.reason, self.is_stepping = StopReason.CEILING, False
