"""The Levenberg-Marquardt loop, for any problem that can be linearised and solved with damping."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic

from labcal.optim.damping import Damping
from labcal.optim.lm_state import LevenbergMarquardtState
from labcal.optim.problem import Batch, BatchLinearization, Linearization, Parameters, Problem
from labcal.optim.solution import Solution
from labcal.optim.stopping import Stopping
from labcal.optim.successive_halving import SuccessiveHalving


def minimize(
    problem: Problem[Parameters],
    start: Parameters,
    stopping: Stopping,
    damping: Damping,
) -> Solution[Parameters]:
    """Lower the cost of a problem by damped Gauss-Newton steps.

    An epoch is one accepted step. A step is accepted when it lowers the cost; otherwise it is tried again
    from the same linearisation with more damping. Levenberg 1944; Marquardt 1963; as in Hagan and Menhaj
    1994.

    Parameters
    ----------
    problem : Problem
        The cost, its linearisation, and the way its damped normal equations are solved.
    start : Parameters
        Initial parameters, in the form that the problem uses.
    stopping : Stopping
        Goal, epochs and gradient at which to stop.
    damping : Damping
        The first damping, and how it changes.

    Returns
    -------
    Solution
        Not reaching the goal is a result: see its `reason`. The parameters are never worse than `start`.
    """
    return minimize_batch(_Alone(problem), [start], stopping, damping)[0]


def minimize_batch(
    batch: Batch[Parameters],
    starts: Sequence[Parameters],
    stopping: Stopping,
    damping: Damping,
    halving: SuccessiveHalving | None = None,
) -> list[Solution[Parameters]]:
    """Lower the costs of several runs at once; each ends as it would alone, unless it is pruned.

    All that are still running take their epochs together. See :func:`minimize`.

    Parameters
    ----------
    batch : Batch
        What the runs have in common.
    starts : sequence of Parameters
        One a run.
    stopping : Stopping
        For every run.
    damping : Damping
        For every run; each has a damping of its own.
    halving : SuccessiveHalving, optional
        The rule by which runs are pruned and kept, by their costs; without one, all are kept.

    Returns
    -------
    list of Solution
        One a run that is kept.
    """
    halving = halving or SuccessiveHalving.keeping_all(len(starts))
    runs = initial_states(batch, starts, stopping, damping)
    while members := [number for number, run in enumerate(runs) if run.reason is None]:
        parameters = [runs[number].parameters for number in members]
        take_epoch(batch, batch.linearize(members, parameters), runs, members)
        halving.prune(runs, [run.cost for run in runs])
    return [runs[number].solution() for number in halving.kept(runs, [run.cost for run in runs])]


def initial_states(
    batch: Batch[Parameters], starts: Sequence[Parameters], stopping: Stopping, damping: Damping
) -> list[LevenbergMarquardtState[Parameters]]:
    """Return the states of the runs of a batch at their initial parameters."""
    costs = batch.costs(range(len(starts)), starts)
    return [
        LevenbergMarquardtState(start, cost, stopping, damping)
        for start, cost in zip(starts, costs, strict=True)
    ]


def take_epoch(
    batch: Batch[Parameters],
    linearization: BatchLinearization[Parameters],
    runs: Sequence[LevenbergMarquardtState[Parameters]],
    members: Sequence[int],
) -> None:
    """Advance each member to its next accepted step, or until it stops.

    Parameters
    ----------
    batch : Batch
        It computes the costs of candidates.
    linearization : BatchLinearization
        Of these members, in their order.
    runs : sequence of LevenbergMarquardtState
        All runs of the batch.
    members : sequence of int
        The indices of those that take part.
    """
    for number, norm in zip(members, linearization.gradient_norms, strict=True):
        runs[number].begin_step(norm)
    while places := [place for place, number in enumerate(members) if runs[number].is_stepping]:
        tried = [members[place] for place in places]
        steps = linearization.stepped(places, [runs[number].mu for number in tried])
        solved = [(number, step) for number, step in zip(tried, steps, strict=True) if step is not None]
        numbers, candidates = [number for number, _ in solved], [step for _, step in solved]
        costs = batch.costs(numbers, candidates) if solved else []
        for number, candidate, cost in zip(numbers, candidates, costs, strict=True):
            runs[number].accept_if_lower(candidate, cost)
        for number in tried:
            if runs[number].is_stepping:
                runs[number].raise_damping()


@dataclass(frozen=True)
class _AloneLinearization(Generic[Parameters]):
    linearization: Linearization[Parameters]

    @property
    def gradient_norms(self) -> list[float]:
        return [self.linearization.gradient_norm]

    def stepped(self, places: Sequence[int], mus: Sequence[float]) -> list[Parameters | None]:  # noqa: ARG002 - there is one
        return [self.linearization.stepped(mu) for mu in mus]


@dataclass(frozen=True)
class _Alone(Generic[Parameters]):
    """A problem as a batch of one run."""

    problem: Problem[Parameters]

    def costs(self, members: Sequence[int], parameters: Sequence[Parameters]) -> list[float]:  # noqa: ARG002 - there is one
        return [self.problem.cost(one) for one in parameters]

    def linearize(
        self,
        members: Sequence[int],  # noqa: ARG002 - there is one
        parameters: Sequence[Parameters],
    ) -> _AloneLinearization[Parameters]:
        return _AloneLinearization(self.problem.linearize(parameters[0]))
