"""The start of a network's weights after Nguyen and Widrow."""

import numpy as np
import torch
from jaxtyping import Float64

from labcal.optim.network import Network


def nguyen_widrow(network: Network, random: np.random.Generator) -> Float64[torch.Tensor, " parameters"]:
    """Draw weights and biases so that the neurons of a layer share out the range of its inputs.

    Inputs are taken to lie in [-1, 1]. Weight vectors of a layer of S neurons and R inputs have random
    directions and the length 0.7 S^(1/R), and biases are uniform over plus and minus that length. The linear
    outputs start uniform in [-1, 1].

    Nguyen and Widrow, "Improving the learning speed of 2-layer neural networks by choosing initial values
    of the adaptive weights", IJCNN 1990. MATLAB's ``initnw`` spaces the biases evenly and doubles
    everything; from there training takes a quarter more epochs than the paper reports (decision "weights").

    Parameters
    ----------
    network : Network
        The shape.
    random : numpy.random.Generator
        Where the numbers come from.

    Returns
    -------
    torch.Tensor
        All parameters of the network, float64.
    """
    parameters = torch.empty(network.parameter_count, dtype=torch.float64)
    *hidden, last = network.layers(parameters)
    for layer in hidden:
        neurons, inputs = layer.shape[0], layer.shape[1] - 1
        length = 0.7 * neurons ** (1 / inputs)
        weights = random.uniform(-1, 1, (neurons, inputs))
        weights *= length / np.linalg.norm(weights, axis=1, keepdims=True)
        biases = random.uniform(-length, length, neurons)
        layer.copy_(torch.from_numpy(np.column_stack((weights, biases))))
    last.copy_(torch.from_numpy(random.uniform(-1, 1, tuple(last.shape))))
    return parameters
