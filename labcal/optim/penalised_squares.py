"""Least squares with a penalty on the squares of the parameters."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import torch
from jaxtyping import Float64

from labcal.optim.normal_equations import NormalEquations

Weights = Float64[torch.Tensor, " p"]


@runtime_checkable  # so that tests can check annotations
class SquaresBatch(Protocol):
    """Several runs of one least-squares problem; see `Batch` for members and parameters."""

    @property
    def residual_count(self) -> int:
        """The number of residuals of one run."""

    def squares(self, members: Sequence[int], parameters: Sequence[Weights]) -> list[float]:
        """Return each run's sum of squared residuals."""

    def linearize(self, members: Sequence[int], parameters: Sequence[Weights]) -> NormalEquations:
        """Return the normal equations of each sum; those of an earlier call may be lost."""


@dataclass(frozen=True)
class Decayed:
    """A `Batch` whose costs are the squares of residuals plus a decay times the squares of parameters.

    Attributes
    ----------
    problem : SquaresBatch
        The residuals.
    decays : list of float
        One a run; they may change between epochs.
    """

    problem: SquaresBatch
    decays: list[float]

    def costs(self, members: Sequence[int], parameters: Sequence[Weights]) -> list[float]:
        """Return squares of residuals plus decayed squares of parameters."""
        squares = self.problem.squares(members, parameters)
        return [
            square + self.decays[member] * float(weights @ weights)
            for square, member, weights in zip(squares, members, parameters, strict=True)
        ]

    def linearize(self, members: Sequence[int], parameters: Sequence[Weights]) -> NormalEquations:
        """Return the decayed normal equations."""
        equations = self.problem.linearize(members, parameters)
        self.decay(equations, members)
        return equations

    def decay(self, equations: NormalEquations, members: Sequence[int]) -> None:
        """Add the decay to the problem's own normal equations."""
        for place, member in enumerate(members):
            equations.diagonal(place)[...] += self.decays[member]
            equations.gradients[place] += self.decays[member] * equations.parameters[place].numpy()
