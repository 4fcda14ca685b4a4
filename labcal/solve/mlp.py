"""The paper's network: pixels in, points out, trained by Levenberg-Marquardt."""

from typing import ClassVar

import numpy as np
import torch
from jaxtyping import Float64

from labcal.errors import InputError
from labcal.optim.damping import Damping
from labcal.optim.levenberg_marquardt import minimize_batch
from labcal.optim.network import Network
from labcal.optim.network_problem import NetworkProblem
from labcal.optim.nguyen_widrow import nguyen_widrow
from labcal.optim.solution import Stopping
from labcal.optim.threads import one_thread
from labcal.rng import generator
from labcal.solve.blas_threads import one_blas_thread
from labcal.solve.estimator import FittedArray, PointEstimator
from labcal.solve.scaling import RangeScaling


class Mlp(PointEstimator):
    """The method ``mlp``: tanh hidden layers, linear outputs, inputs and outputs scaled to [-1, 1].

    All data are one batch. Training stops at the goal, after `max_epochs` accepted steps, or where damping
    finds no better step; `stop_reason_` says which. Not reaching the goal is a result and raises nothing.

    Parameters
    ----------
    hidden : tuple of int
        Neurons of every hidden layer: ``(20, 30)`` is the paper's [20-30-3]. Empty for a linear network.
    goal : float
        Mean squared error over all scaled outputs at which to stop.
    max_epochs : int
        Accepted steps after which to stop.
    random_state : int
        Seed of the first weights; the same seed and data give the same bytes.

    Attributes
    ----------
    parameters_ : float64 array
        All weights and biases, ordered as in `Network`.
    input_centre_, input_half_range_, output_centre_, output_half_range_ : float64 array
        The scalings.
    n_iter_ : int
        Epochs, that is, accepted steps.
    stop_reason_ : str
        A value of `StopReason`.
    mse_ : float
        The mean squared error over all scaled outputs at the end.
    history_ : float64 array, (epochs + 1,)
        The same at the start and after every epoch.
    """

    method: ClassVar[str] = "mlp"
    fitted_facts: ClassVar[tuple[str, ...]] = ("n_iter_", "stop_reason_", "mse_")

    def __init__(
        self,
        hidden: tuple[int, ...] = (20, 30),
        goal: float = 1e-7,
        max_epochs: int = 5000,
        random_state: int = 0,
    ) -> None:
        self.hidden = hidden
        self.goal = goal
        self.max_epochs = max_epochs
        self.random_state = random_state

    def fitted_arrays(self) -> tuple[FittedArray, ...]:
        """Return which arrays the fitted estimator consists of."""
        return (
            FittedArray("parameters_", (self._network().parameter_count,)),
            FittedArray("input_centre_", (self.n_features_in_,)),
            FittedArray("input_half_range_", (self.n_features_in_,)),
            FittedArray("output_centre_", (self.n_outputs_,)),
            FittedArray("output_half_range_", (self.n_outputs_,)),
            FittedArray("history_", (self.n_iter_ + 1,)),
        )

    def _fit(self, pixels: Float64[np.ndarray, "n inputs"], points: Float64[np.ndarray, "n outputs"]) -> None:
        self._refuse_parameters()
        network = self._network()
        inputs, outputs = RangeScaling.of(pixels), RangeScaling.of(points)
        start = nguyen_widrow(network, generator(self.random_state, "mlp", "start"))
        problem = NetworkProblem(
            network, torch.from_numpy(inputs.scaled(pixels)), torch.from_numpy(outputs.scaled(points))
        )
        with one_thread(), one_blas_thread():
            (solution,) = minimize_batch(problem, [start], Stopping(self.goal, self.max_epochs), Damping())
        self.parameters_ = solution.parameters.numpy()
        self.input_centre_, self.input_half_range_ = inputs.centre, inputs.half_range
        self.output_centre_, self.output_half_range_ = outputs.centre, outputs.half_range
        self.n_iter_, self.stop_reason_, self.mse_ = solution.epochs, str(solution.reason), solution.cost
        self.history_ = solution.history.cost

    def _predict(self, pixels: Float64[np.ndarray, "n inputs"]) -> Float64[np.ndarray, "n outputs"]:
        inputs = RangeScaling(self.input_centre_, self.input_half_range_)
        outputs = RangeScaling(self.output_centre_, self.output_half_range_)
        with one_thread():
            _, scaled = self._network().forward(
                torch.from_numpy(self.parameters_), torch.from_numpy(inputs.scaled(pixels))
            )
        return outputs.restored(scaled.numpy())

    def _network(self) -> Network:
        """Return the shape for the present inputs and outputs."""
        return Network((self.n_features_in_, *self.hidden, self.n_outputs_))

    def _refuse_parameters(self) -> None:
        """Raise where a constructor argument cannot be used; scikit-learn wants that here, not before."""
        if self.goal < 0 or self.max_epochs < 0 or self.random_state < 0:
            raise InputError(
                f"{self.method}: goal, max_epochs and random_state must not be negative, but are "
                f"{self.goal}, {self.max_epochs} and {self.random_state}."
            )
