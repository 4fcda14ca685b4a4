"""A feed-forward network: tanh hidden layers, linear outputs, and its derivatives in closed form."""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import torch
from jaxtyping import Float64

from labcal.errors import InputError


@dataclass(frozen=True)
class Network:
    """The shape of a network; its parameters are one flat float64 tensor kept elsewhere.

    Layer after layer, a neuron's parameters are its input weights followed by its bias.

    Attributes
    ----------
    sizes : tuple of int
        Inputs, neurons of every hidden layer, outputs: ``(4, 20, 30, 3)``.

    Raises
    ------
    InputError
        A layer without neurons, or no layer at all.
    """

    sizes: tuple[int, ...]

    def __post_init__(self) -> None:
        """Refuse empty layers."""
        if len(self.sizes) < 2 or min(self.sizes) < 1:  # noqa: PLR2004 - inputs and outputs
            raise InputError(
                f"A network needs inputs, outputs and no empty layer, but got the sizes {self.sizes}."
            )

    @cached_property
    def spans(self) -> tuple[tuple[int, int], ...]:
        """The first parameter of every layer, and the one after its last."""
        ends = [0]
        for inputs, neurons in pairwise(self.sizes):
            ends.append(ends[-1] + neurons * (inputs + 1))
        return tuple(pairwise(ends))

    @property
    def parameter_count(self) -> int:
        """The number of weights and biases."""
        return self.spans[-1][1]

    def layers(self, parameters: Float64[torch.Tensor, " parameters"]) -> list[Float64[torch.Tensor, "_ _"]]:
        """Return views of the parameters, one (neurons, inputs + 1) matrix a layer, the bias last."""
        return [
            parameters[first:end].view(neurons, inputs + 1)
            for (first, end), (inputs, neurons) in zip(self.spans, pairwise(self.sizes), strict=True)
        ]

    def forward(
        self, parameters: Float64[torch.Tensor, " parameters"], inputs: Float64[torch.Tensor, "n _"]
    ) -> tuple[list[Float64[torch.Tensor, "n _"]], Float64[torch.Tensor, "n outputs"]]:
        """Return what enters every layer, with a column of ones for the bias, and the outputs."""
        *hidden, last = self.layers(parameters)
        ones = inputs.new_ones((len(inputs), 1))
        entering = [torch.cat((inputs, ones), dim=1)]
        for weights in hidden:
            entering.append(torch.cat((torch.tanh(entering[-1] @ weights.T), ones), dim=1))
        return entering, entering[-1] @ last.T

    def sensitivities(
        self, parameters: Float64[torch.Tensor, " parameters"], entering: list[Float64[torch.Tensor, "n _"]]
    ) -> list[Float64[torch.Tensor, "n outputs _"]]:
        """Return, for every hidden layer, the derivatives of the outputs by the sums that its neurons form.

        The output layer is left out: there the derivative is the identity.
        """
        layers = self.layers(parameters)
        outputs = self.sizes[-1]
        backward = layers[-1][:, :-1].expand(len(entering[0]), outputs, self.sizes[-2])
        found: list[torch.Tensor] = []
        for index in range(len(layers) - 2, -1, -1):
            slope = 1 - entering[index + 1][:, :-1].square()
            sensitivity = backward * slope[:, None, :]
            found.append(sensitivity)
            backward = sensitivity @ layers[index][:, :-1]
        return found[::-1]

    def input_jacobian(
        self, parameters: Float64[torch.Tensor, " parameters"], inputs: Float64[torch.Tensor, "n _"]
    ) -> Float64[torch.Tensor, "n outputs inputs"]:
        """Return the derivatives of all outputs by all inputs."""
        entering, _ = self.forward(parameters, inputs)
        first = self.layers(parameters)[0][:, :-1]
        sensitivities = self.sensitivities(parameters, entering)
        if not sensitivities:
            return first.expand(len(inputs), *first.shape)
        return sensitivities[0] @ first

    def jacobian(
        self, parameters: Float64[torch.Tensor, " parameters"], inputs: Float64[torch.Tensor, "n _"]
    ) -> Float64[torch.Tensor, "n outputs parameters"]:
        """Return the derivatives of all outputs by all parameters, in closed form."""
        entering, _ = self.forward(parameters, inputs)
        outputs = self.sizes[-1]
        identity = torch.eye(outputs, dtype=inputs.dtype).expand(len(inputs), outputs, outputs)
        sensitivities = [*self.sensitivities(parameters, entering), identity]
        blocks = [
            (sensitivity[..., None] * values[:, None, None, :]).flatten(2)
            for sensitivity, values in zip(sensitivities, entering, strict=True)
        ]
        return torch.cat(blocks, dim=2)
