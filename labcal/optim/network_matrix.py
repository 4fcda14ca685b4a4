"""J'J and J'r of a network, from its structure and never from J itself."""

from itertools import combinations

import numpy as np
from jaxtyping import Float64

from labcal.optim.network import Network
from labcal.optim.network_blocks import HiddenCross, HiddenSquare, OutputCross

Rows = Float64[np.ndarray, "_ n"]
Sensitivity = Float64[np.ndarray, "outputs _ n"]


class NetworkMatrix:
    """Assembles the normal equations of one network after the other in memory that is used again and again.

    The derivative of output k by the weight from value p to neuron i is S[k, i] A[p], with S the sensitivity
    of the neuron and A what enters the layer. A block of J'J is therefore the sum over points of
    (sum over k of S[k, i] S'[k, j]) A[p] A'[q]: the outputs are summed before the two factors are multiplied
    out, and within one layer both factors are symmetric, so that a quarter of the products is enough. In the
    last hidden layer S[k, i] = w[k, i] s[i], with the output's weight w and the slope s: there the sum over
    outputs leaves the sum over points.

    Parameters
    ----------
    network : Network
        The shape.
    points : int
        Number of points.
    """

    def __init__(self, network: Network, points: int) -> None:
        self._spans = [slice(*span) for span in network.spans]
        *widths, self._last_width = (size + 1 for size in network.sizes[:-1])
        neurons = network.sizes[1:-1]
        self._squares = [HiddenSquare(*shape, points) for shape in zip(neurons, widths, strict=True)]
        self._crosses = {
            (row, column): HiddenCross((neurons[row], neurons[column]), (widths[row], widths[column]), points)
            for column, row in combinations(range(len(neurons)), 2)
        }
        self._of_outputs = [
            OutputCross(self._last_width, *shape, points) for shape in zip(neurons, widths, strict=True)
        ]

    def fill(
        self,
        layers: list[Float64[np.ndarray, "_ _"]],
        entering: list[Rows],
        residuals: Rows,
        matrix: Float64[np.ndarray, "p p"],
        gradient: Float64[np.ndarray, " p"],
    ) -> None:
        """Write the lower triangle of J'J, and J'r.

        Parameters
        ----------
        layers : list of float64 array
            The weights of every layer, the bias last.
        entering : list of float64 array
            What enters every layer, a row a value, the last row ones.
        residuals : float64 array, (outputs, n)
            Of every output at every point.
        matrix, gradient : float64 array
            Where to write. Above its diagonal the matrix is left in any state.
        """
        slopes = [1.0 - values[:-1] ** 2 for values in entering[1:]]
        sensitivities = _sensitivities(layers, slopes)
        if slopes:
            self._fill_last_hidden(layers[-1][:, :-1], slopes[-1], sensitivities, entering, matrix)
        self._fill_hidden(sensitivities[:-1], entering, matrix)
        self._fill_outputs(layers[-1][:, :-1], entering, sensitivities, slopes, matrix)
        for span, sensitivity, values in zip(self._spans, sensitivities, entering, strict=False):
            summed = (sensitivity * residuals[:, None]).sum(axis=0)
            gradient[span] = (summed @ values.T).ravel()
        gradient[self._spans[-1]] = (residuals @ entering[-1].T).ravel()

    def _fill_last_hidden(
        self,
        weights: Float64[np.ndarray, "outputs neurons"],
        slope: Rows,
        sensitivities: list[Sensitivity],
        entering: list[Rows],
        matrix: Float64[np.ndarray, "p p"],
    ) -> None:
        """Fill the rows of the last hidden layer."""
        row = len(sensitivities) - 1
        rows = self._spans[row]
        self._squares[row].write(slope[None], weights.T @ weights, entering[row], matrix[rows, rows])
        for column in range(row):
            cross = self._crosses[row, column]
            cross.sum_last_slopes(weights, slope, sensitivities[column])
            cross.write(entering[row], entering[column], matrix[rows, self._spans[column]])

    def _fill_hidden(
        self,
        sensitivities: list[Sensitivity],
        entering: list[Rows],
        matrix: Float64[np.ndarray, "p p"],
    ) -> None:
        """Fill the rows of the hidden layers before the last one."""
        for row, own in enumerate(sensitivities):
            rows, neurons = self._spans[row], own.shape[1]
            self._squares[row].write(own, np.ones((neurons, neurons)), entering[row], matrix[rows, rows])
            for column, earlier in enumerate(sensitivities[:row]):
                cross = self._crosses[row, column]
                cross.sum_slopes(own, earlier)
                cross.write(entering[row], entering[column], matrix[rows, self._spans[column]])

    def _fill_outputs(
        self,
        weights: Float64[np.ndarray, "outputs neurons"],
        entering: list[Rows],
        sensitivities: list[Sensitivity],
        slopes: list[Rows],
        matrix: Float64[np.ndarray, "p p"],
    ) -> None:
        """Fill the rows of the linear outputs, of which each depends on its own weights only."""
        outputs, width, last = len(weights), self._last_width, entering[-1]
        rows = matrix[self._spans[-1]]
        own = rows[:, self._spans[-1]].reshape(outputs, width, outputs, width)
        own[...] = 0.0
        own[range(outputs), :, range(outputs)] = last @ last.T
        blocks = rows.reshape(outputs, width, -1)
        for column, cross in enumerate(self._of_outputs):
            columns = blocks[:, :, self._spans[column]]
            if column == len(slopes) - 1:
                cross.write(slopes[-1], (entering[column], last), weights, columns)
                continue
            for k, sensitivity in enumerate(sensitivities[column]):
                one = np.ones((1, len(sensitivity)))
                cross.write(sensitivity, (entering[column], last), one, columns[k : k + 1])


def _sensitivities(layers: list[Float64[np.ndarray, "_ _"]], slopes: list[Rows]) -> list[Sensitivity]:
    """Return, for every hidden layer, the derivatives of the outputs by the sums that its neurons form."""
    found: list[np.ndarray] = []
    for index in range(len(slopes) - 1, -1, -1):
        weights = layers[index + 1][:, :-1]
        backward = np.matmul(weights.T, found[-1]) if found else weights[:, :, None]
        found.append(backward * slopes[index])
    return found[::-1]
