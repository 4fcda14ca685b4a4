"""The paper's network: pixels in, points out, trained by Levenberg-Marquardt."""

from typing import ClassVar

import torch
from jaxtyping import Float64

from labcal.errors import InputError
from labcal.estimators.networks.network_estimator import NetworkEstimator
from labcal.optim.damping import Damping
from labcal.optim.levenberg_marquardt import minimize_batch
from labcal.optim.network_problem import NetworkProblem
from labcal.optim.stopping import Stopping
from labcal.optim.successive_halving import SuccessiveHalving


class Mlp(NetworkEstimator):
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
    members : int
        Number of networks, trained from different starts; the prediction is their mean.
    restarts : int
        Starts that are tried for each member; the best are kept, by the mean squared error.
    random_state : int
        Seed of the first weights; the same seed and data give the same bytes.

    Attributes
    ----------
    parameters_ : float64 array, (members, parameters)
        All weights and biases, ordered as in `Network`.
    input_centre_, input_half_range_, output_centre_, output_half_range_ : float64 array
        The scalings.
    n_iter_ : int
        Epochs, that is, accepted steps, of the member that took most.
    stop_reason_ : str
        A value of `StopReason`; where members differ, all of theirs.
    mse_ : float
        The mean squared error over all scaled outputs at the end, the mean over the members.
    history_ : float64 array, (epochs + 1,)
        The same at the start and after every epoch.
    """

    method: ClassVar[str] = "mlp"

    def __init__(
        self,
        hidden: tuple[int, ...] = (20, 30),
        goal: float = 1e-7,
        max_epochs: int = 5000,
        members: int = 1,
        restarts: int = 1,
        random_state: int = 0,
    ) -> None:
        self.hidden = hidden
        self.goal = goal
        self.max_epochs = max_epochs
        self.members = members
        self.restarts = restarts
        self.random_state = random_state

    def _train(self, problem: NetworkProblem, starts: list[Float64[torch.Tensor, " p"]]) -> None:
        stopping, halving = (
            Stopping(self.goal, self.max_epochs),
            SuccessiveHalving([range(len(starts))], self.members),
        )
        solutions = minimize_batch(problem, starts, stopping, Damping(), halving)
        self._keep(solutions, [solution.history.cost for solution in solutions])

    def _refuse_parameters(self) -> None:
        super()._refuse_parameters()
        if self.goal < 0:
            raise InputError(f"{self.method}: goal must not be negative, but is {self.goal}.")
