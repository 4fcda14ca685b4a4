"""The least-squares problem of training a network on all data at once."""

import torch
from jaxtyping import Float64, Int64

from labcal.optim.network import Network
from labcal.optim.normal_equations import NormalEquations


class NetworkProblem:
    """Fit a network's outputs to targets; the cost is the mean squared error over points and outputs.

    J'J is assembled from the structure of the network, never from J itself. The derivative of output k by
    the weight from value p to neuron i is S[k, i] A[p], with S the sensitivity of the neuron and A what
    enters the layer. A block of J'J is therefore the sum over points of (sum over k of S[k, i] S'[k, j])
    A[p] A'[q]: the outputs are summed before the two factors are multiplied out, and within one layer both
    factors are symmetric, so that a quarter of the products is enough.

    Parameters
    ----------
    network : Network
        The shape.
    inputs, targets : float64 tensor
        One row a point, scaled.
    """

    def __init__(
        self,
        network: Network,
        inputs: Float64[torch.Tensor, "n _"],
        targets: Float64[torch.Tensor, "n outputs"],
    ) -> None:
        self.network = network
        self.inputs = inputs
        self.targets = targets
        self._pairs = {size: torch.tril_indices(size, size) for size in self._packed_sizes()}
        self._unpacking = [
            _unpacking(neurons, entering + 1)
            for entering, neurons in zip(network.sizes[:-2], network.sizes[1:-1], strict=True)
        ]

    def cost(self, parameters: Float64[torch.Tensor, " p"]) -> float:
        """Return the mean squared error over all points and outputs."""
        _, outputs = self.network.forward(parameters, self.inputs)
        return float((outputs - self.targets).square().mean())

    def linearize(self, parameters: Float64[torch.Tensor, " p"]) -> NormalEquations:
        """Return the normal equations of the sum of squared errors."""
        entering, outputs = self.network.forward(parameters, self.inputs)
        sensitivities = self.network.sensitivities(parameters, entering)
        residuals = outputs - self.targets
        gradient = [
            (torch.einsum("nk,nki->ni", residuals, sensitivity).T @ values).flatten()
            for sensitivity, values in zip(sensitivities, entering[:-1], strict=True)
        ]
        gradient.append((residuals.T @ entering[-1]).flatten())
        return NormalEquations(parameters, self._matrix(entering, sensitivities), torch.cat(gradient))

    def _packed_sizes(self) -> set[int]:
        """Return the sizes of all symmetric factors of hidden layers."""
        return {*self.network.sizes[1:-1], *(size + 1 for size in self.network.sizes[:-2])}

    def _matrix(self, entering: list[torch.Tensor], sensitivities: list[torch.Tensor]) -> torch.Tensor:
        """Return J'J, its lower triangle filled."""
        spans = self.network.spans
        matrix = torch.zeros((self.network.parameter_count,) * 2, dtype=torch.float64)
        for row, sensitivity in enumerate(sensitivities):
            rows = slice(*spans[row])
            matrix[rows, rows] = self._hidden_square(row, sensitivity, entering[row])
            for column in range(row):
                matrix[rows, slice(*spans[column])] = _hidden_cross(
                    sensitivity, entering[row], sensitivities[column], entering[column]
                )
        self._fill_outputs(matrix, entering, sensitivities)
        return matrix

    def _hidden_square(self, layer: int, sensitivity: torch.Tensor, values: torch.Tensor) -> torch.Tensor:
        """Return the block of one hidden layer with itself, from packed symmetric factors."""
        size, width = sensitivity.shape[2], values.shape[1]
        rows, columns = self._pairs[size]
        slopes = (sensitivity.mT @ sensitivity).flatten(1).index_select(1, rows * size + columns)
        first, second = self._pairs[width]
        turned = values.T.contiguous()
        packed = slopes.T @ (turned[first] * turned[second]).T
        return packed.flatten().index_select(0, self._unpacking[layer]).view(size * width, size * width)

    def _fill_outputs(
        self, matrix: torch.Tensor, entering: list[torch.Tensor], sensitivities: list[torch.Tensor]
    ) -> None:
        """Fill the rows of the linear outputs, of which each depends on its own weights only."""
        values = entering[-1]
        first, _ = self.network.spans[-1]
        width = values.shape[1]
        square = values.T @ values
        for k in range(self.network.sizes[-1]):
            own = slice(first + k * width, first + (k + 1) * width)
            matrix[own, own] = square
            for span, sensitivity, others in zip(self.network.spans, sensitivities, entering, strict=False):
                product = (sensitivity[:, k, :, None] * others[:, None, :]).flatten(1)
                matrix[own, slice(*span)] = values.T @ product


def _hidden_cross(
    sensitivity: torch.Tensor, values: torch.Tensor, earlier: torch.Tensor, earlier_values: torch.Tensor
) -> torch.Tensor:
    """Return the block of one hidden layer with an earlier one."""
    slopes = (sensitivity.mT @ earlier).flatten(1)
    products = (values[:, :, None] * earlier_values[:, None, :]).flatten(1)
    block = (slopes.T @ products).view(
        sensitivity.shape[2], earlier.shape[2], values.shape[1], earlier_values.shape[1]
    )
    return block.transpose(1, 2).flatten(0, 1).flatten(1)


def _unpacking(neurons: int, values: int) -> Int64[torch.Tensor, " _"]:
    """Return where a block's elements (i p, j q) stand in the packed product of pairs (i j) and (p q)."""
    neuron_pairs, value_pairs = _packed_index(neurons), _packed_index(values)
    count = values * (values + 1) // 2
    index = neuron_pairs[:, None, :, None] * count + value_pairs[None, :, None, :]
    return index.flatten()


def _packed_index(size: int) -> Int64[torch.Tensor, "size size"]:
    """Return where element (i, j) of a symmetric matrix stands among those of its lower triangle."""
    rows, columns = torch.tril_indices(size, size)
    index = torch.empty((size, size), dtype=torch.int64)
    index[rows, columns] = torch.arange(len(rows))
    index[columns, rows] = index[rows, columns]
    return index
