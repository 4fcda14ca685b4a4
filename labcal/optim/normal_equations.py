"""Dense normal equations of several runs, damped and solved by Cholesky."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float64
from scipy.linalg.lapack import dpotrf, dpotrs

Weights = Float64[torch.Tensor, " p"]


@dataclass(frozen=True)
class NormalEquations:
    """J'J and J'r of several runs, each at a point of its own; a `BatchLinearization` of the loop.

    Attributes
    ----------
    parameters : list of float64 tensor
        The points.
    matrices : float64 array, (runs, p, p)
        J'J; only the lower triangles are read.
    gradients : float64 array, (runs, p)
        J'r.
    """

    parameters: list[Weights]
    matrices: Float64[np.ndarray, "runs p p"]
    gradients: Float64[np.ndarray, "runs p"]
    scratch: Float64[np.ndarray, "p p"]
    """Memory in which a damped matrix is factored."""

    @classmethod
    def empty(cls, runs: int, count: int) -> "NormalEquations":
        """Return memory for so many runs of so many parameters each."""
        return cls([], np.empty((runs, count, count)), np.empty((runs, count)), np.empty((count, count)))

    def first(self, parameters: list[Weights]) -> "NormalEquations":
        """Return the part of this memory that as many runs need."""
        runs = len(parameters)
        return NormalEquations(parameters, self.matrices[:runs], self.gradients[:runs], self.scratch)

    @property
    def gradient_norms(self) -> list[float]:
        """The largest absolute component of each J'r."""
        return [float(norm) for norm in np.abs(self.gradients).max(axis=1)]

    def stepped(self, places: Sequence[int], mus: Sequence[float]) -> list[Weights | None]:
        """Return the parameters of some runs after the damped step, None where a pivot is not positive."""
        return [self._step(place, mu) for place, mu in zip(places, mus, strict=True)]

    def diagonal(self, place: int) -> Float64[np.ndarray, " p"]:
        """Return the diagonal of one matrix, to be changed in place."""
        return np.asarray(self.matrices[place].reshape(-1)[:: self.matrices.shape[1] + 1])

    def factor(self, place: int, mu: float) -> Float64[np.ndarray, "p p"] | None:
        """Return the upper Cholesky factor R with R'R = J'J + mu I, or None; the next call overwrites it.

        Its lower triangle is left in any state.
        """
        np.copyto(self.scratch, self.matrices[place])
        self.scratch.reshape(-1)[:: len(self.scratch) + 1] += mu
        # The lower triangle by rows is the upper one by columns, as LAPACK reads it: nothing is copied.
        factor, failed = dpotrf(self.scratch.T, lower=0, clean=0, overwrite_a=1)
        return None if failed else factor

    def _step(self, place: int, mu: float) -> Weights | None:
        factor = self.factor(place, mu)
        if factor is None:
            return None
        step, _ = dpotrs(factor, self.gradients[place], lower=0)
        return self.parameters[place] - torch.from_numpy(step)
