"""The result of an optimisation: parameters, cost, history and the reason why it stopped."""

from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from jaxtyping import Float64

from labcal.optim.stopping import StopReason

Parameters = TypeVar("Parameters")


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
