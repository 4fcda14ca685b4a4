"""The Levenberg-Marquardt loop, for any problem that can be linearised and solved with damping."""

import math

import numpy as np

from labcal.optim.damping import Damping
from labcal.optim.problem import Linearization, Parameters, Problem
from labcal.optim.solution import History, Solution, Stopping, StopReason


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
        Where to begin; what the problem understands.
    stopping : Stopping
        Goal, epochs and gradient at which to stop.
    damping : Damping
        The first damping, and how it changes.

    Returns
    -------
    Solution
        Not reaching the goal is a result: see its `reason`. The parameters are never worse than `start`.
    """
    parameters, cost, mu = start, problem.cost(start), damping.start
    costs, dampings = [cost], [mu]
    while True:
        reason = _reason_to_stop(cost, len(costs) - 1, stopping)
        if reason is not None:
            break
        linearization = problem.linearize(parameters)
        if linearization.gradient_norm <= stopping.min_gradient:
            reason = StopReason.GRADIENT
            break
        accepted, mu = _accepted_step(problem, linearization, cost, mu, damping)
        if accepted is None:
            reason = StopReason.CEILING
            break
        parameters, cost = accepted
        mu = damping.after_success(mu)
        costs.append(cost)
        dampings.append(mu)
    history = History(np.array(costs), np.array(dampings))
    return Solution(parameters, cost, reason, len(costs) - 1, mu, history)


def _reason_to_stop(cost: float, epochs: int, stopping: Stopping) -> StopReason | None:
    """Return why no further step is needed or possible, or None."""
    if not math.isfinite(cost):
        return StopReason.NOT_FINITE
    if cost <= stopping.goal:
        return StopReason.GOAL
    if epochs >= stopping.max_epochs:
        return StopReason.EPOCHS
    return None


def _accepted_step(
    problem: Problem[Parameters],
    linearization: Linearization[Parameters],
    cost: float,
    mu: float,
    damping: Damping,
) -> tuple[tuple[Parameters, float] | None, float]:
    """Return the first step that lowers the cost, or None at the ceiling, and the damping it came to."""
    while mu <= damping.ceiling:
        candidate = linearization.stepped(mu)
        if candidate is not None:
            candidate_cost = problem.cost(candidate)
            if candidate_cost < cost:  # False for NaN too
                return (candidate, candidate_cost), mu
        mu = damping.after_failure(mu)
    return None, mu
