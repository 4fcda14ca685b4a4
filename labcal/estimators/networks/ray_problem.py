"""The least-squares problem of training ray networks for each camera."""

from collections.abc import Sequence

import numpy as np
import torch
from jaxtyping import Float64

from labcal.optim.inner_products import own_inner_products
from labcal.optim.network import Network
from labcal.optim.normal_equations import NormalEquations

Weights = Float64[torch.Tensor, " p"]


class RayProblem:
    """Residuals ``D o - d``, linear in a network's outputs o; a `SquaresBatch`.

    Its members are of one camera after the other, and of the first again: member m is of camera m modulo
    their number.

    Parameters
    ----------
    network : Network
        The shape of every camera's.
    inputs : float64 tensor, (cameras, n, 2)
        Scaled pixels.
    slopes : float64 array, (cameras, n, 2, outputs)
        D, px.
    targets : float64 array, (cameras, n, 2)
        d, px.
    starts : int
        How many networks of each camera are trained at once.
    """

    def __init__(
        self,
        network: Network,
        inputs: Float64[torch.Tensor, "cameras n 2"],
        slopes: Float64[np.ndarray, "cameras n 2 outputs"],
        targets: Float64[np.ndarray, "cameras n 2"],
        starts: int = 1,
    ) -> None:
        self.network, self._inputs = network, inputs
        self._slopes, self._targets = slopes, targets
        self.residual_count = targets[0].size
        self._equations = NormalEquations.empty(starts * len(inputs), network.parameter_count)

    def squares(self, members: Sequence[int], parameters: Sequence[Weights]) -> list[float]:
        """Return each network's sum of squared residuals, px squared."""
        pairs = zip(members, parameters, strict=True)
        return [float(np.square(self._residuals(member, own)).sum()) for member, own in pairs]

    def linearize(self, members: Sequence[int], parameters: Sequence[Weights]) -> NormalEquations:
        """Return the normal equations of each sum; the next call overwrites them."""
        equations = self._equations.first(list(parameters))
        for place, (member, own) in enumerate(zip(members, parameters, strict=True)):
            camera = member % len(self._inputs)
            of_outputs = self.network.jacobian(own, self._inputs[camera]).numpy()
            jacobian = np.matmul(self._slopes[camera], of_outputs).reshape(self.residual_count, -1)
            rows = np.ascontiguousarray(jacobian.T)
            own_inner_products(rows, equations.matrices[place])
            equations.gradients[place] = rows @ self._residuals(member, own).ravel()
        return equations

    def _residuals(self, member: int, parameters: Weights) -> Float64[np.ndarray, "n 2"]:
        camera = member % len(self._inputs)
        outputs = self.network.forward(parameters, self._inputs[camera])[1].numpy()
        combined = np.matmul(self._slopes[camera], outputs[:, :, None])[:, :, 0]
        return np.asarray(combined - self._targets[camera])
