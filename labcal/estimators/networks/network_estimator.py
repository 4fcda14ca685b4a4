"""The common part of networks from pixels to points: scaling, restarts, ensembles."""

from abc import abstractmethod
from collections.abc import Sequence
from typing import ClassVar, Protocol, runtime_checkable

import numpy as np
import torch
from jaxtyping import Float64

from labcal.errors import InputError
from labcal.estimators.estimator import COORDINATES, FittedArray, PointEstimator
from labcal.estimators.scaling import RangeScaling
from labcal.optim.network import Network
from labcal.optim.network_problem import NetworkProblem
from labcal.optim.nguyen_widrow import nguyen_widrow
from labcal.optim.stopping import StopReason
from labcal.rng import generator
from labcal.run.threads import one_blas_thread, one_torch_thread

Pixels = Float64[np.ndarray, "n inputs"]


@runtime_checkable  # so that tests can check annotations
class Trained(Protocol):
    """The end of the training of one network."""

    @property
    def parameters(self) -> Float64[torch.Tensor, " p"]:
        """The weights."""

    @property
    def reason(self) -> StopReason:
        """The reason why it stopped."""

    @property
    def epochs(self) -> int:
        """Accepted steps."""


class NetworkEstimator(PointEstimator):
    """Tanh hidden layers and linear outputs, inputs and outputs scaled to [-1, 1], one network or several.

    All starts are trained as one batch, of which the best become members (see `SuccessiveHalving`). Several
    members predict their mean, and what they differ by enters the covariance.

    Attributes
    ----------
    hidden : tuple of int
        Neurons of every hidden layer.
    max_epochs : int
        Accepted steps after which to stop.
    members : int
        Number of networks.
    restarts : int
        Starts that are tried for each member; the best are kept.
    random_state : int
        Seed of the first weights.
    parameters_ : float64 array, (members, parameters)
        All weights and biases, ordered as in `Network`.
    input_centre_, input_half_range_, output_centre_, output_half_range_ : float64 array
        The scalings.
    n_iter_, stop_reason_, mse_, history_
        As for `Mlp`.
    """

    fitted_facts: ClassVar[tuple[str, ...]] = ("n_iter_", "stop_reason_", "mse_")
    hidden: tuple[int, ...]
    max_epochs: int
    members: int
    restarts: int
    random_state: int

    def fitted_arrays(self) -> tuple[FittedArray, ...]:
        """Return the arrays that make up the fitted estimator."""
        return (
            FittedArray("parameters_", (self.members, self._network().parameter_count)),
            FittedArray("input_centre_", (self.n_features_in_,)),
            FittedArray("input_half_range_", (self.n_features_in_,)),
            FittedArray("output_centre_", (self.n_outputs_,)),
            FittedArray("output_half_range_", (self.n_outputs_,)),
            FittedArray("history_", (self.n_iter_ + 1,)),
        )

    @abstractmethod
    def _train(self, problem: NetworkProblem, starts: list[Float64[torch.Tensor, " p"]]) -> None:
        """Train from all starts, and store what came of it; :meth:`_keep` does so for the members."""

    def _keep(self, members: Sequence[Trained], histories: list[Float64[np.ndarray, " states"]]) -> None:
        """Store parameters and course of the training of the members, whose mean squared errors are given."""
        self.parameters_ = np.stack([member.parameters.numpy() for member in members])
        self.n_iter_ = max(member.epochs for member in members)
        self.stop_reason_ = joint_reason([str(member.reason) for member in members])
        self.history_ = mean_history(histories)
        self.mse_ = float(self.history_[-1])

    def _fit(self, pixels: Pixels, points: Float64[np.ndarray, "n outputs"]) -> None:
        self._refuse_parameters()
        network = self._network()
        inputs, outputs = RangeScaling.of(pixels), RangeScaling.of(points)
        self.input_centre_, self.input_half_range_ = inputs.centre, inputs.half_range
        self.output_centre_, self.output_half_range_ = outputs.centre, outputs.half_range
        # The first start is named as it was before there were others.
        count = self.members * self.restarts
        names: list[tuple[str, ...]] = [(), *((str(number),) for number in range(1, count))]
        starts = [
            nguyen_widrow(network, generator(self.random_state, "mlp", "start", *name)) for name in names
        ]
        problem = NetworkProblem(
            network,
            self._scaled(pixels),
            torch.from_numpy(outputs.scaled(points)),
            count,
        )
        with one_torch_thread(), one_blas_thread():
            self._train(problem, starts)

    def _predict(self, pixels: Pixels) -> Float64[np.ndarray, "n outputs"]:
        predicted = self._predictions(pixels)
        return predicted[0] if len(predicted) == 1 else np.asarray(predicted.mean(axis=0))

    def _covariance_parts(
        self, pixels: Pixels, pixel_covariance: Float64[np.ndarray, "n cameras 2 2"]
    ) -> tuple[Float64[np.ndarray, "n dim dim"], Float64[np.ndarray, "n dim dim"]]:
        noise, own = super()._covariance_parts(pixels, pixel_covariance)
        return noise, np.asarray(own + self._spread(pixels))

    def _spread(self, pixels: Pixels) -> Float64[np.ndarray, "n dim dim"]:
        """Return the covariance of the members' predictions; zero where there is one."""
        apart = self._predictions(pixels)[:, :, :COORDINATES]
        apart = apart - apart.mean(axis=0)
        return np.asarray(np.einsum("mni,mnj->nij", apart, apart) / len(apart))

    def _predictions(self, pixels: Pixels) -> Float64[np.ndarray, "members n outputs"]:
        """Return what each member predicts."""
        scaled, network = self._scaled(pixels), self._network()
        outputs = RangeScaling(self.output_centre_, self.output_half_range_)
        with one_torch_thread():
            return np.stack(
                [
                    outputs.restored(network.forward(torch.from_numpy(own), scaled)[1].numpy())
                    for own in self.parameters_
                ]
            )

    def _scaled(self, pixels: Pixels) -> Float64[torch.Tensor, "n inputs"]:
        """Return pixels as the networks take them."""
        return torch.from_numpy(RangeScaling(self.input_centre_, self.input_half_range_).scaled(pixels))

    def _network(self) -> Network:
        """Return the shape for the present inputs and outputs."""
        return Network((self.n_features_in_, *self.hidden, self.n_outputs_))

    def _refuse_parameters(self) -> None:
        """Raise where a constructor argument cannot be used; scikit-learn wants that here, not before."""
        if self.max_epochs < 0 or self.random_state < 0:
            raise InputError(
                f"{self.method}: max_epochs and random_state must not be negative, but are "
                f"{self.max_epochs} and {self.random_state}."
            )
        for name, value in (("members", self.members), ("restarts", self.restarts)):
            if value < 1:
                raise InputError(f"{self.method}: {name} must be 1 or more, but is {value}.")


def mean_history(histories: list[Float64[np.ndarray, " states"]]) -> Float64[np.ndarray, " longest"]:
    """Return the mean course of several members; one that has stopped keeps its last value."""
    longest = max(map(len, histories))
    return np.asarray(
        np.mean([np.pad(own, (0, longest - len(own)), mode="edge") for own in histories], axis=0)
    )


def joint_reason(reasons: list[str]) -> str:
    """Return the stop reasons of members, each once."""
    return ", ".join(dict.fromkeys(reasons))
