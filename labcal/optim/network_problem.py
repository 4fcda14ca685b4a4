"""The least-squares problem of training networks on all data at once."""

from collections.abc import Sequence

import numpy as np
import torch
from jaxtyping import Float64

from labcal.optim.network import Network
from labcal.optim.network_matrix import NetworkMatrix
from labcal.optim.network_signals import SignalRuns, Signals, layers
from labcal.optim.normal_equations import NormalEquations

Weights = Float64[torch.Tensor, " p"]


class NetworkProblem:
    """Fit the outputs of networks to targets; the cost is the mean squared error over points and outputs.

    A `Batch`: several starts of one network are trained together.

    Parameters
    ----------
    network : Network
        The shape.
    inputs, targets : float64 tensor
        One row a point, scaled.
    members : int
        How many networks are trained at once.
    """

    def __init__(
        self,
        network: Network,
        inputs: Float64[torch.Tensor, "n _"],
        targets: Float64[torch.Tensor, "n outputs"],
        members: int = 1,
    ) -> None:
        self.network = network
        self.residual_count = targets.numel()
        self._targets = np.ascontiguousarray(targets.numpy().T)
        self._signals = SignalRuns(network, inputs[None], members)
        self._assembly = NetworkMatrix(network, len(inputs))
        count = network.parameter_count
        self._equations = NormalEquations.empty(members, count)

    def costs(self, members: Sequence[int], parameters: Sequence[Weights]) -> list[float]:
        """Return each network's mean squared error over all points and outputs."""
        return [square / self.residual_count for square in self.squares(members, parameters)]

    def squares(self, members: Sequence[int], parameters: Sequence[Weights]) -> list[float]:
        """Return each network's sum of squared errors."""
        _, signals = self._run(members, parameters)
        return [float(np.vdot(residuals, residuals)) for residuals in signals.outputs - self._targets]

    def linearize(self, members: Sequence[int], parameters: Sequence[Weights]) -> NormalEquations:
        """Return the normal equations of each sum of squared errors; the next call overwrites them."""
        stacked, signals = self._run(members, parameters)
        equations = self._equations.first(list(parameters))
        weights = layers(self.network, stacked)
        for place, residuals in enumerate(signals.outputs - self._targets):
            self._assembly.fill(
                [layer[place] for layer in weights],
                [values[min(place, len(values) - 1)] for values in signals.entering],
                residuals,
                equations.matrices[place],
                equations.gradients[place],
            )
        return equations

    def _run(
        self, members: Sequence[int], parameters: Sequence[Weights]
    ) -> tuple[Float64[np.ndarray, "members p"], Signals]:
        """Return the parameters as one array, and what they make of the inputs."""
        stacked = torch.stack(list(parameters)).numpy()
        return stacked, self._signals.run(list(members), stacked)
