"""Duration of network training compared with ``torch-levenberg-marquardt``, and of restarts."""

import logging
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import numpy as np
import torch
from jaxtyping import Float64

from labcal.bench.groups import Bench, Findings
from labcal.estimators.scaling import RangeScaling
from labcal.optim.damping import Damping
from labcal.optim.levenberg_marquardt import minimize_batch
from labcal.optim.network import Network
from labcal.optim.network_problem import NetworkProblem
from labcal.optim.nguyen_widrow import nguyen_widrow
from labcal.optim.stopping import Stopping
from labcal.optim.successive_halving import SuccessiveHalving
from labcal.paper.rows import Data, PaperRow, Solver
from labcal.paper.simulated import NoiseReading, simulate
from labcal.report.bench import Check, Figure, at_most
from labcal.rng import generator
from labcal.run.threads import one_blas_thread, one_torch_thread

PEER = "torch_levenberg_marquardt"
ROW = PaperRow("training", Solver.NETWORK, Data.VOLUME, 520, 0.0, 0.0, (20, 30), 1e-8)
"""The paper's volume with as many points as its four planes."""
GOAL = 1e-8
MEMBERS = 8
ROUNDS, QUICK_ROUNDS = 9, 3
EPOCH_LIMIT, GOAL_LIMIT, ASSEMBLY_LIMIT, BATCH_LIMIT = 0.55, 0.5, 0.5, 6.0
PATIENCE = 300
"""Epochs after which the goal is not waited for any longer."""


@dataclass(frozen=True)
class _Task:
    network: Network
    inputs: Float64[torch.Tensor, "n inputs"]
    targets: Float64[torch.Tensor, "n outputs"]
    starts: list[Float64[torch.Tensor, " p"]]

    @classmethod
    def of(cls, seed: int) -> "_Task":
        """Return the scaled problem, and starts, of which the first is used in all comparisons."""
        data = simulate(ROW, NoiseReading.NONE, seed)
        network = Network((data.X.shape[1], *ROW.hidden, data.Y.shape[1]))
        X, Y = (torch.from_numpy(RangeScaling.of(part).scaled(part)) for part in (data.X, data.Y))
        random = (generator(seed, "bench solve", "training", str(member)) for member in range(MEMBERS))
        return cls(network, X, Y, [nguyen_widrow(network, own) for own in random])

    def problem(self, members: int) -> NetworkProblem:
        """Return the problem for a number of networks."""
        return NetworkProblem(self.network, self.inputs, self.targets, members)


def training_findings(bench: Bench) -> Findings:
    """Return ratios of times, each pair measured in turn with one thread, the least of several rounds.

    The other software gets every chance: Cholesky in place of its default QR, and its own damping or the
    same steps as ours, whichever is faster.
    """
    rounds = QUICK_ROUNDS if bench.quick else ROUNDS
    task = _Task.of(bench.seed)
    bench.progress.start("training", 3)
    with one_torch_thread(), one_blas_thread():
        checks, references = _own_ratios(task, rounds)
        bench.progress.advance()
        checks += _batch_ratios(task, rounds)
        bench.progress.advance()
        if find_spec(PEER) is None:
            note = "training: torch-levenberg-marquardt is not installed; the extra 'bench' brings it"
            return Findings(checks, references, (note,))
        of_peer, peer_references = _peer_ratios(task, rounds)
    bench.progress.advance()
    return Findings([*of_peer, *checks], peer_references + references)


def _own_ratios(task: _Task, rounds: int) -> tuple[list[Check], list[Figure]]:
    """Return the time of assembly over that of the plain product, in torch and in symmetric NumPy form."""
    problem, start = task.problem(1), task.starts[:1]
    J = task.network.jacobian(start[0], task.inputs).flatten(0, 1).contiguous()
    array = J.numpy()
    assembly, product, symmetric = _least(
        rounds,
        partial(problem.linearize, [0], start),
        lambda: J.T @ J,
        lambda: array.T @ array,
    )
    name = "training, J'J and J'r: time over that of the product J.T @ J"
    return (
        [at_most(name, assembly / product, ASSEMBLY_LIMIT)],
        [Figure(name=f"{name} in NumPy", value=assembly / symmetric)],
    )


def _batch_ratios(task: _Task, rounds: int) -> list[Check]:
    """Return times of restarts and of an ensemble over the mean of single starts, all to the goal.

    Of restarts the best is wanted, so that the others are given up on the way; an ensemble needs them all.
    """
    stopping = Stopping(GOAL, PATIENCE)
    one, many = task.problem(1), task.problem(MEMBERS)
    halving = SuccessiveHalving([range(MEMBERS)])
    *alone, restarts, ensemble = _least(
        max(rounds // 3, 2),
        *(partial(minimize_batch, one, [start], stopping, Damping()) for start in task.starts),
        partial(minimize_batch, many, task.starts, stopping, Damping(), halving),
        partial(minimize_batch, many, task.starts, stopping, Damping()),
    )
    mean = float(np.mean(alone))
    name = f"training, a batch of {MEMBERS} restarts of which the best is kept: time over that of one"
    of_all = f"training, a batch of {MEMBERS}, an ensemble, all to their end: time over that of one"
    return [at_most(name, restarts / mean, BATCH_LIMIT), at_most(of_all, ensemble / mean, BATCH_LIMIT)]


def _peer_ratios(task: _Task, rounds: int) -> tuple[list[Check], list[Figure]]:
    """Return epoch and time to the goal over those of ``torch-levenberg-marquardt``, from the same start."""
    own_epochs, own_goal, peer_epochs, peer_goal = [], [], [], []
    problem = task.problem(1)
    steps = len(task.inputs)
    for _ in range(max(rounds // 3, 2)):
        began = time.perf_counter()
        (solution,) = minimize_batch(problem, task.starts[:1], Stopping(GOAL, PATIENCE), Damping())
        own_goal.append(time.perf_counter() - began)
        own_epochs.append(own_goal[-1] / solution.epochs)
        # Its normal equations are divided by the number of points, so that this damping is ours.
        for damping in ({}, {"starting_value": Damping().start / steps, "min_value": 1e-300}):
            times = _peer_times(task, damping)
            peer_epochs.append(float(np.mean(times)))
            peer_goal.append(sum(times))
    epoch, goal = min(own_epochs) / min(peer_epochs), min(own_goal) / min(peer_goal)
    peer = "that of torch-levenberg-marquardt"
    return (
        [
            at_most(f"training, an epoch: time over {peer}", epoch, EPOCH_LIMIT),
            at_most(f"training, to a mean squared error of {GOAL:g}: time over {peer}", goal, GOAL_LIMIT),
        ],
        [
            Figure(name="training, an epoch: labcal, s", value=min(own_epochs)),
            Figure(name="training, an epoch: torch-levenberg-marquardt, s", value=min(peer_epochs)),
            Figure(name="training, epochs to the goal: labcal", value=solution.epochs),
        ],
    )


def _peer_times(task: _Task, damping: dict[str, float]) -> list[float]:
    """Return the duration of each epoch of ``torch-levenberg-marquardt`` up to the goal."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of Lightning, which it imports
        peer: Any = import_module(PEER)
    logging.getLogger(PEER).setLevel(logging.ERROR)  # it warns of every step that it tries in vain
    modules: list[torch.nn.Module] = []
    for layer in task.network.layers(task.starts[0]):
        linear = torch.nn.Linear(layer.shape[1] - 1, layer.shape[0], dtype=torch.float64)
        linear.weight.data, linear.bias.data = layer[:, :-1].clone(), layer[:, -1].clone()
        modules += [linear, torch.nn.Tanh()]
    training = peer.training.LevenbergMarquardtModule(
        torch.nn.Sequential(*modules[:-1]),
        loss_fn=peer.loss.MSELoss(),
        damping_strategy=peer.damping.StandardDampingStrategy(**damping),
        solve_method="cholesky",
        attempts_per_step=50,
    )
    times: list[float] = []
    loss, stopped = float("inf"), False
    while loss > GOAL and not stopped and len(times) < PATIENCE:
        began = time.perf_counter()
        _, value, stopped, _ = training.training_step(task.inputs, task.targets)
        times.append(time.perf_counter() - began)
        loss = float(value)
    return times


def _least(rounds: int, *calls: Callable[[], object]) -> list[float]:
    """Return the least duration of each call, all measured in turn."""
    least = [float("inf")] * len(calls)
    for _ in range(rounds):
        for number, call in enumerate(calls):
            began = time.perf_counter()
            call()
            least[number] = min(least[number], time.perf_counter() - began)
    return least
