"""Dense normal equations in torch, damped and solved by Cholesky."""

from dataclasses import dataclass

import torch
from jaxtyping import Float64


@dataclass(frozen=True)
class NormalEquations:
    """J'J and J'r at one point; a `Linearization` of the loop.

    Attributes
    ----------
    parameters : float64 tensor
        The point.
    matrix : float64 tensor
        J'J; only the lower triangle is read.
    gradient : float64 tensor
        J'r.
    """

    parameters: Float64[torch.Tensor, " p"]
    matrix: Float64[torch.Tensor, "p p"]
    gradient: Float64[torch.Tensor, " p"]

    @property
    def gradient_norm(self) -> float:
        """The largest absolute component of J'r."""
        return float(self.gradient.abs().max())

    def stepped(self, mu: float) -> Float64[torch.Tensor, " p"] | None:
        """Return the parameters after the damped step, or None where Cholesky meets a negative pivot."""
        damped = self.matrix.clone()
        damped.diagonal().add_(mu)
        factor, failed = torch.linalg.cholesky_ex(damped)
        if int(failed):
            return None
        step = torch.cholesky_solve(self.gradient[:, None], factor)[:, 0]
        return self.parameters - step
