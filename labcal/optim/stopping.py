"""The rule by which an optimisation stops, and the reasons."""

import math
from dataclasses import dataclass
from enum import StrEnum


class StopReason(StrEnum):
    """The reason why an optimisation stopped. None of these is an error."""

    GOAL = "goal reached"
    EPOCHS = "epochs exhausted"
    CEILING = "damping ceiling"
    GRADIENT = "gradient vanished"
    NOT_FINITE = "cost not finite"
    SETTLED = "evidence settled"
    PRUNED = "pruned by successive halving"


@dataclass(frozen=True)
class Stopping:
    """Conditions under which an optimisation stops.

    Attributes
    ----------
    goal : float
        Stop as soon as the cost is at or below this.
    max_epochs : int
        Stop after so many accepted steps.
    min_gradient : float
        Stop when the largest component of J'r is at or below this; 0 stops at an exact stationary point only.
    """

    goal: float = 0.0
    max_epochs: int = 100
    min_gradient: float = 0.0

    def reason(self, cost: float, epochs: int) -> StopReason | None:
        """Return the reason to stop at a cost after so many epochs; None to go on."""
        if not math.isfinite(cost):
            return StopReason.NOT_FINITE
        if cost <= self.goal:
            return StopReason.GOAL
        return StopReason.EPOCHS if epochs >= self.max_epochs else None

    def reason_of_gradient(self, norm: float) -> StopReason | None:
        """Return the reason to stop at a norm of J'r; None to go on."""
        return StopReason.GRADIENT if norm <= self.min_gradient else None
