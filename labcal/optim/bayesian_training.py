"""Training with evidence-based weight decay, which is updated in every epoch (MacKay 1992)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float64

from labcal.optim.damping import Damping
from labcal.optim.decay_by_evidence import Evidence
from labcal.optim.levenberg_marquardt import initial_states, take_epoch
from labcal.optim.penalised_squares import Decayed, SquaresBatch
from labcal.optim.stopping import Stopping, StopReason
from labcal.optim.successive_halving import SuccessiveHalving

Weights = Float64[torch.Tensor, " p"]

SETTLED = 0.1
"""Change of the log evidence in an epoch below which it counts as unchanged."""
EPOCHS_UNCHANGED = 10
"""Epochs in a row without a change after which it has converged."""


@dataclass(frozen=True)
class BayesianSolution:
    """The result of one run.

    Attributes
    ----------
    parameters : float64 tensor
        The weights.
    evidence : Evidence
        The scales, at the last linearisation.
    factor : float64 array, (p, p)
        Lower Cholesky factor of beta J'J + alpha I; the weights' covariance is half of its inverse.
    reason : StopReason
        The reason why it stopped.
    epochs : int
        Accepted steps.
    history : float64 array, (epochs + 1,)
        Mean squared residual at the start and after every epoch.
    """

    parameters: Weights
    evidence: Evidence
    factor: Float64[np.ndarray, "p p"]
    reason: StopReason
    epochs: int
    history: Float64[np.ndarray, " states"]


def train_by_evidence(
    problem: SquaresBatch,
    starts: Sequence[Weights],
    max_epochs: int,
    damping: Damping,
    halving: SuccessiveHalving | None = None,
) -> list[BayesianSolution]:
    """Train several runs at once, each with its own scales of weights and data.

    Every epoch estimates the scales anew and takes one accepted Levenberg-Marquardt step of the objective
    beta E_D + alpha E_W (Foresee and Hagan 1997).

    Parameters
    ----------
    problem : SquaresBatch
        The residuals and their normal equations.
    starts : sequence of float64 tensor
        The first weights, one a run.
    max_epochs : int
        Accepted steps after which to stop.
    damping : Damping
        The first damping, and how it changes.
    halving : SuccessiveHalving, optional
        The rule by which runs are pruned and kept, by the squared residuals expected of new data; without
        one, all are kept.

    Returns
    -------
    list of BayesianSolution
        One for each run that is kept. Evidence that has not converged is a result, not an error.
    """
    halving = halving or SuccessiveHalving.keeping_all(len(starts))
    everyone = range(len(starts))
    count = problem.residual_count
    squares = problem.squares(everyone, starts)
    evidences = [
        Evidence.start(square, float(start @ start), (count, len(start)))
        for square, start in zip(squares, starts, strict=True)
    ]
    histories = [[square / count] for square in squares]
    log_evidences: list[list[float]] = [[] for _ in everyone]
    decayed = Decayed(problem, [evidence.decay for evidence in evidences])
    runs = initial_states(decayed, starts, Stopping(max_epochs=max_epochs), damping)
    while members := [number for number in everyone if runs[number].reason is None]:
        parameters = [runs[number].parameters for number in members]
        equations = problem.linearize(members, parameters)
        for place, square in enumerate(problem.squares(members, parameters)):
            number = members[place]
            evidences[number] = evidences[number].updated(equations, place, square, count)
            log_evidences[number].append(evidences[number].log_evidence)
            decayed.decays[number] = evidences[number].decay
            if _has_converged(log_evidences[number]):
                runs[number].stop(StopReason.SETTLED)
        halving.prune(runs, [evidence.expected_square(count) for evidence in evidences])
        for number, cost in zip(members, decayed.costs(members, parameters), strict=True):
            runs[number].set_cost(cost)
        decayed.decay(equations, members)
        take_epoch(decayed, equations, runs, members)
        after = [runs[number].parameters for number in members]
        for number, square in zip(members, problem.squares(members, after), strict=True):
            if runs[number].epochs == len(histories[number]):
                histories[number].append(square / count)
    kept = halving.kept(runs, [evidence.expected_square(count) for evidence in evidences])
    equations = problem.linearize(kept, [runs[number].parameters for number in kept])
    return [
        BayesianSolution(
            runs[number].parameters,
            evidences[number],
            evidences[number].weight_factor(equations, place),
            runs[number].reason or StopReason.EPOCHS,
            runs[number].epochs,
            np.array(histories[number]),
        )
        for place, number in enumerate(kept)
    ]


def _has_converged(log_evidence: list[float]) -> bool:
    """Return whether the log evidence has hardly changed for several epochs."""
    recent = np.array(log_evidence[-EPOCHS_UNCHANGED - 1 :])
    return len(recent) > EPOCHS_UNCHANGED and bool(np.abs(np.diff(recent)).max() <= SETTLED)
