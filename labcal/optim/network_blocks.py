"""The blocks of a network's J'J, each with the memory in which it is formed."""

import numpy as np
from jaxtyping import Float64

from labcal.optim.inner_products import inner_products
from labcal.optim.packed_pairs import PackedPairs

Rows = Float64[np.ndarray, "_ n"]


class HiddenSquare:
    """The block of one hidden layer with itself; both of its factors are symmetric and kept packed.

    Parameters
    ----------
    neurons, width, points : int
        Neurons of the layer, values that enter it (with the one of the bias), points.
    """

    def __init__(self, neurons: int, width: int, points: int) -> None:
        self._neurons, self._values = PackedPairs(neurons), PackedPairs(width)
        self._unpacking = self._values.unpacking()
        self._slopes = np.empty((self._neurons.count, points))
        self._addend = np.empty_like(self._slopes)
        self._products = np.empty((self._values.count, points))
        self._packed = np.empty((self._neurons.count, self._values.count))
        self._blocks = np.empty((self._neurons.count, width * width))

    def write(
        self,
        factors: Float64[np.ndarray, "terms neurons n"],
        scale: Float64[np.ndarray, "neurons neurons"],
        values: Rows,
        out: Float64[np.ndarray, "p p"],
    ) -> None:
        """Write the sum over points and terms of ``scale[i, j] f[i] f[j] A[p] A[q]``, lower triangle only."""
        first, *others = factors
        self._neurons.multiply(first, self._slopes)
        for factor in others:
            self._neurons.multiply(factor, self._addend)
            self._slopes += self._addend
        self._values.multiply(values, self._products)
        inner_products(self._slopes, self._products, self._packed)
        self._packed *= self._neurons.lower(scale)[:, None]
        np.take(self._packed, self._unpacking, axis=1, out=self._blocks, mode="clip")
        width = self._values.size
        for i in range(self._neurons.size):
            blocks = self._blocks[self._neurons.row(i)].reshape(i + 1, width, width)
            rows = out[i * width : (i + 1) * width, : (i + 1) * width]
            rows.reshape(width, i + 1, width)[...] = blocks.transpose(1, 0, 2)


class HiddenCross:
    """The block of one hidden layer with an earlier one.

    Parameters
    ----------
    neurons, widths : (int, int)
        Of the layer and of the earlier one.
    points : int
        Number of points.
    """

    def __init__(self, neurons: tuple[int, int], widths: tuple[int, int], points: int) -> None:
        self._neurons, self._widths = neurons, widths
        self.slopes = np.empty((*neurons, points))
        """To be filled: the derivatives by neuron i of the layer and j of the earlier one, outputs summed."""
        self._addend = np.empty_like(self.slopes)
        self._products = np.empty((*widths, points))
        self._block = np.empty((neurons[0] * neurons[1], widths[0] * widths[1]))

    def sum_slopes(
        self, own: Float64[np.ndarray, "outputs neurons n"], earlier: Float64[np.ndarray, "outputs _ n"]
    ) -> None:
        """Fill the slopes from the sensitivities of both layers."""
        self.slopes[...] = 0.0
        for one, other in zip(own, earlier, strict=True):
            np.multiply(one[:, None], other, out=self._addend)
            self.slopes += self._addend

    def sum_last_slopes(
        self,
        weights: Float64[np.ndarray, "outputs neurons"],
        slope: Rows,
        earlier: Float64[np.ndarray, "outputs _ n"],
    ) -> None:
        """Fill the slopes where the layer is the last hidden one, with sensitivities w[k, i] s[i]."""
        flat = self.slopes.reshape(len(slope), -1)
        np.matmul(weights.T, earlier.reshape(len(weights), -1), out=flat)
        self.slopes *= slope[:, None]

    def write(self, values: Rows, earlier: Rows, out: Float64[np.ndarray, "p q"]) -> None:
        """Write the sum over points of the slopes times the values that enter both layers."""
        np.multiply(values[:, None], earlier, out=self._products)
        points = self.slopes.shape[2]
        inner_products(self.slopes.reshape(-1, points), self._products.reshape(-1, points), self._block)
        (rows, columns), (width, earlier_width) = self._neurons, self._widths
        block = self._block.reshape(rows, columns, width, earlier_width).transpose(0, 2, 1, 3)
        out.reshape(rows, width, columns, earlier_width)[...] = block


class OutputCross:
    """The block of the linear outputs with a hidden layer.

    Parameters
    ----------
    outputs_width, neurons, width, points : int
        Values that enter the outputs, neurons of the layer, values that enter it, points.
    """

    def __init__(self, outputs_width: int, neurons: int, width: int, points: int) -> None:
        self._products = np.empty((neurons, width, points))
        self._block = np.empty((outputs_width, neurons * width))

    def write(
        self,
        factors: Float64[np.ndarray, "neurons n"],
        entering: tuple[Rows, Rows],
        scale: Float64[np.ndarray, "rows neurons"],
        out: Float64[np.ndarray, "rows outputs_width p"],
    ) -> None:
        """Write the sum over points of ``scale[k, i] f[i] A[p] Z[q]`` for every k.

        Parameters
        ----------
        factors : float64 array
            Derivatives by the neurons.
        entering : (float64 array, float64 array)
            What enters the layer, and what enters the outputs.
        scale : float64 array
            A row for each row of blocks.
        out : float64 array
            Where to write.
        """
        values, last = entering
        np.multiply(factors[:, None], values, out=self._products)
        inner_products(last, self._products.reshape(-1, last.shape[1]), self._block)
        neurons, width = self._products.shape[:2]
        block = self._block.reshape(-1, neurons, width)
        for k, weights in enumerate(scale):
            np.multiply(block, weights[:, None], out=out[k].reshape(-1, neurons, width))
