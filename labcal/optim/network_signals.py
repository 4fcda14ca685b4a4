"""The values that enter and leave the layers of several networks of one shape."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import torch
from jaxtyping import Float64

from labcal.optim.network import Network


@dataclass(frozen=True)
class Signals:
    """The inputs of every layer of each network, and the outputs of the last one; one row per neuron.

    Attributes
    ----------
    entering : list of float64 array
        For every layer (members, neurons before it + 1, n), the last row ones for the bias. Of inputs that
        the networks share there is one member only.
    outputs : float64 array
        Of the last layer.
    """

    entering: list[Float64[np.ndarray, "_ _ n"]]
    outputs: Float64[np.ndarray, "members outputs n"]


class SignalRuns:
    """Runs inputs through networks in memory that is used again and again.

    Parameters
    ----------
    network : Network
        The shape of all.
    inputs : float64 tensor, (1 or members, n, inputs)
        Shared by all networks, or each one's own.
    members : int
        Number of networks.
    """

    def __init__(self, network: Network, inputs: Float64[torch.Tensor, "_ n inputs"], members: int) -> None:
        self._network = network
        count = inputs.shape[1]
        ones = torch.ones((len(inputs), count, 1), dtype=torch.float64)
        self._first = np.ascontiguousarray(torch.cat((inputs, ones), dim=2).mT.numpy())
        self._hidden = [np.ones((members, size + 1, count)) for size in network.sizes[1:-1]]
        self._outputs = np.empty((members, network.sizes[-1], count))

    def run(self, members: list[int], parameters: Float64[np.ndarray, "members p"]) -> Signals:
        """Return the signals of some of the networks; the next run overwrites them."""
        count = len(members)
        first = self._first if len(self._first) == 1 else self._first[members]
        entering = [first, *(buffer[:count] for buffer in self._hidden)]
        *hidden, last = layers(self._network, parameters)
        for weights, (before, after) in zip(hidden, pairwise(entering), strict=True):
            sums = np.matmul(weights, before, out=after[:, :-1])
            # Several times faster in torch than in NumPy.
            torch.tanh(torch.from_numpy(sums), out=torch.from_numpy(sums))
        return Signals(entering, np.matmul(last, entering[-1], out=self._outputs[:count]))


def layers(
    network: Network, parameters: Float64[np.ndarray, "members p"]
) -> list[Float64[np.ndarray, "members _ _"]]:
    """Return views of the parameters, one (members, neurons, inputs + 1) array a layer, the bias last."""
    return [
        parameters[:, first:end].reshape(len(parameters), neurons, inputs + 1)
        for (first, end), (inputs, neurons) in zip(network.spans, pairwise(network.sizes), strict=True)
    ]
