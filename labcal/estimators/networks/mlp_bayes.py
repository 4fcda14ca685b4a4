"""The network of the paper with evidence-based weight decay."""

from typing import ClassVar

import numpy as np
import torch
from jaxtyping import Float64
from scipy.linalg import solve_triangular

from labcal.estimators.estimator import COORDINATES, FittedArray
from labcal.estimators.networks.network_estimator import NetworkEstimator
from labcal.estimators.propagation import propagated_covariance
from labcal.optim.bayesian_training import train_by_evidence
from labcal.optim.damping import Damping
from labcal.optim.network_problem import NetworkProblem
from labcal.optim.successive_halving import SuccessiveHalving
from labcal.run.threads import one_blas_thread, one_torch_thread

AT_ONCE = 500
"""Points whose derivatives by all weights are held at once."""


class MlpBayes(NetworkEstimator):
    """The method ``mlp-bayes``: `Mlp` with Bayesian regularisation (Foresee and Hagan 1997).

    The objective is beta E_D + alpha E_W, with the squared errors E_D and the squared weights E_W; every
    epoch estimates alpha and beta anew from the effective number of parameters, until the evidence settles.
    Nothing has to be held out and no goal be chosen. Where the data have no noise at all there is little to
    settle, and `max_epochs` ends the training.

    The covariance of a point is that of its pixels' noise, propagated through the network, and that of the
    weights, linearised (MacKay 1992); members of an ensemble count alike, since Laplace's evidence tells
    their errors badly (decision "evidence every epoch").

    Parameters
    ----------
    hidden : tuple of int
        Neurons of every hidden layer; more than are needed do no harm.
    max_epochs : int
        Accepted steps after which to stop.
    members : int
        Number of networks, trained from different starts; the prediction is their mean.
    restarts : int
        Starts that are tried for each member; the best are kept, by the error to expect of new data.
    random_state : int
        Seed of the first weights; the same seed and data give the same bytes.

    Attributes
    ----------
    parameters_ : float64 array, (members, parameters)
        All weights and biases, ordered as in `Network`.
    input_centre_, input_half_range_, output_centre_, output_half_range_ : float64 array
        The scalings.
    scales_ : float64 array, (members, 2)
        alpha and beta.
    weight_factors_ : float64 array, (members, parameters, parameters)
        Lower Cholesky factors of beta J'J + alpha I; the weights' covariance is half of its inverse.
    effective_parameters_ : float
        How many parameters the data determine, the mean over the members.
    log_evidence_ : float
        Of the data, in scaled outputs; the mean over the members.
    n_iter_, stop_reason_, mse_, history_
        As for `Mlp`.
    """

    method: ClassVar[str] = "mlp-bayes"
    fitted_facts: ClassVar[tuple[str, ...]] = (
        *NetworkEstimator.fitted_facts, "effective_parameters_", "log_evidence_",
    )  # fmt: skip

    def __init__(
        self,
        hidden: tuple[int, ...] = (20, 30),
        max_epochs: int = 300,
        members: int = 1,
        restarts: int = 1,
        random_state: int = 0,
    ) -> None:
        self.hidden = hidden
        self.max_epochs = max_epochs
        self.members = members
        self.restarts = restarts
        self.random_state = random_state

    def fitted_arrays(self) -> tuple[FittedArray, ...]:
        """Return the arrays that make up the fitted estimator."""
        count = self._network().parameter_count
        return (
            *super().fitted_arrays(),
            FittedArray("scales_", (self.members, 2)),
            FittedArray("weight_factors_", (self.members, count, count)),
        )

    def _train(self, problem: NetworkProblem, starts: list[Float64[torch.Tensor, " p"]]) -> None:
        halving = SuccessiveHalving([range(len(starts))], self.members)
        solutions = train_by_evidence(problem, starts, self.max_epochs, Damping(), halving)
        self._keep(solutions, [solution.history for solution in solutions])
        evidences = [solution.evidence for solution in solutions]
        self.scales_ = np.array([(evidence.alpha, evidence.beta) for evidence in evidences])
        self.effective_parameters_ = float(np.mean([one.effective_parameters for one in evidences]))
        self.log_evidence_ = float(np.mean([evidence.log_evidence for evidence in evidences]))
        self.weight_factors_ = np.stack([solution.factor for solution in solutions])

    def _covariance_parts(
        self,
        pixels: Float64[np.ndarray, "n inputs"],
        pixel_covariance: Float64[np.ndarray, "n cameras 2 2"],
    ) -> tuple[Float64[np.ndarray, "n dim dim"], Float64[np.ndarray, "n dim dim"]]:
        propagated = propagated_covariance(self._coordinates, pixels, pixel_covariance)
        return propagated, np.asarray(self._of_weights(pixels) + self._spread(pixels))

    def _of_weights(self, pixels: Float64[np.ndarray, "n inputs"]) -> Float64[np.ndarray, "n dim dim"]:
        """Return the covariance of predictions by that of the weights, the mean over the members."""
        scaled, network = self._scaled(pixels), self._network()
        half_range = self.output_half_range_[:COORDINATES]
        total = np.zeros((len(pixels), len(half_range), len(half_range)))
        with one_torch_thread(), one_blas_thread():
            for own, factor in zip(self.parameters_, self.weight_factors_, strict=True):
                for first in range(0, len(pixels), AT_ONCE):
                    rows = slice(first, first + AT_ONCE)
                    jacobian = network.jacobian(torch.from_numpy(own), scaled[rows])[:, :COORDINATES].numpy()
                    flat = jacobian.reshape(-1, jacobian.shape[2])
                    whitened = solve_triangular(factor, flat.T, lower=True).T.reshape(jacobian.shape)
                    total[rows] += 0.5 * whitened @ whitened.mT
        return total * np.outer(half_range, half_range) / len(self.parameters_)
