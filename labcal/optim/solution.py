"""The result of an optimisation: parameters, cost, history and the reason why it stopped."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Generic, TypeVar

import numpy as np
from jaxtyping import Float64

Parameters = TypeVar("Parameters")


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


@dataclass(frozen=True)
class History:
    """The course of an optimisation; element 0 is the start, element k the state after epoch k.

    Attributes
    ----------
    cost : float64 array
        The cost.
    mu : float64 array
        The damping with which the next step is tried first.
    """

    cost: Float64[np.ndarray, " states"]
    mu: Float64[np.ndarray, " states"]


@dataclass(frozen=True)
class Solution(Generic[Parameters]):
    """The result of an optimisation.

    Attributes
    ----------
    parameters : Parameters
        The parameters with the lowest cost.
    cost : float
        Their cost.
    reason : StopReason
        Why it stopped.
    epochs : int
        Accepted steps.
    mu : float
        The last damping.
    history : History
        Cost and damping of every epoch.
    """

    parameters: Parameters
    cost: float
    reason: StopReason
    epochs: int
    mu: float
    history: History
