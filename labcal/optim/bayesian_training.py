"""Training with weight decay that the evidence sets anew every epoch."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float64

from labcal.optim.damping import Damping
from labcal.optim.evidence import Evidence
from labcal.optim.levenberg_marquardt import begun, take_epoch
from labcal.optim.restarts import Race
from labcal.optim.solution import Stopping, StopReason
from labcal.optim.weight_decay import Decayed, SquaresBatch

Weights = Float64[torch.Tensor, " p"]

SETTLED = 0.1
"""Change of the log evidence by an epoch below which it stands still."""
EPOCHS_AT_REST = 10
"""Epochs in a row without a change after which it has settled."""


@dataclass(frozen=True)
class BayesianSolution:
    """The end of one run.

    Attributes
    ----------
    parameters : float64 tensor
        The weights.
    evidence : Evidence
        The scales, at the last linearisation.
    factor : float64 array, (p, p)
        Lower Cholesky factor of beta J'J + alpha I; the weights' covariance is half of its inverse.
    reason : StopReason
        Why it stopped.
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
    race: Race | None = None,
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
    race : Race, optional
        Which runs are given up on the way and which are kept, by the squared residuals to expect of new
        data; without one, all are kept.

    Returns
    -------
    list of BayesianSolution
        One a run that is kept; that the evidence has not settled is a result.
    """
    race = race or Race.without_losers(len(starts))
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
    runs = begun(decayed, starts, Stopping(max_epochs=max_epochs), damping)
    while members := [number for number in everyone if runs[number].reason is None]:
        parameters = [runs[number].parameters for number in members]
        equations = problem.linearize(members, parameters)
        for place, square in enumerate(problem.squares(members, parameters)):
            number = members[place]
            evidences[number] = evidences[number].again(equations, place, square, count)
            log_evidences[number].append(evidences[number].log_evidence)
            decayed.decays[number] = evidences[number].decay
            if _at_rest(log_evidences[number]):
                runs[number].stop(StopReason.SETTLED)
        race.judge(runs, [evidence.expected_square(count) for evidence in evidences])
        for number, cost in zip(members, decayed.costs(members, parameters), strict=True):
            runs[number].restate(cost)
        decayed.decay(equations, members)
        take_epoch(decayed, equations, runs, members)
        after = [runs[number].parameters for number in members]
        for number, square in zip(members, problem.squares(members, after), strict=True):
            if runs[number].epochs == len(histories[number]):
                histories[number].append(square / count)
    kept = race.kept(runs, [evidence.expected_square(count) for evidence in evidences])
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


def _at_rest(log_evidence: list[float]) -> bool:
    """Return whether the log evidence has hardly changed for several epochs."""
    recent = np.array(log_evidence[-EPOCHS_AT_REST - 1 :])
    return len(recent) > EPOCHS_AT_REST and bool(np.abs(np.diff(recent)).max() <= SETTLED)
