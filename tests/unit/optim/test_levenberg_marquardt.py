"""The loop on NumPy problems: it must not depend on any array library."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.optimize import least_squares

from labcal.errors import InputError
from labcal.optim.damping import Damping
from labcal.optim.levenberg_marquardt import minimize
from labcal.optim.solution import Solution
from labcal.optim.stopping import Stopping, StopReason


@dataclass(frozen=True)
class Linear:
    x: np.ndarray
    r: np.ndarray
    J: np.ndarray

    @property
    def gradient_norm(self) -> float:
        return float(np.abs(self.J.T @ self.r).max())

    def stepped(self, mu: float) -> np.ndarray:
        return self.x - np.linalg.solve(self.J.T @ self.J + mu * np.eye(len(self.x)), self.J.T @ self.r)


@dataclass(frozen=True)
class NumpyProblem:
    residuals: Callable[[np.ndarray], np.ndarray]
    jacobian: Callable[[np.ndarray], np.ndarray]

    def cost(self, x: np.ndarray) -> float:
        return float(0.5 * np.sum(self.residuals(x) ** 2))

    def linearize(self, x: np.ndarray) -> Linear:
        return Linear(x, self.residuals(x), self.jacobian(x))


def rosenbrock() -> NumpyProblem:
    return NumpyProblem(
        lambda x: np.array([10 * (x[1] - x[0] ** 2), 1 - x[0]]),
        lambda x: np.array([[-20 * x[0], 10.0], [-1.0, 0.0]]),
    )


def decay(noise: float) -> NumpyProblem:
    t = np.linspace(0, 4, 60)
    y = 2.5 * np.exp(-1.3 * t) + 0.5 + noise * np.random.default_rng(3).standard_normal(60)
    return NumpyProblem(
        lambda x: x[0] * np.exp(-x[1] * t) + x[2] - y,
        lambda x: np.column_stack((np.exp(-x[1] * t), -x[0] * t * np.exp(-x[1] * t), np.ones(60))),
    )


def solve(problem: NumpyProblem, start: list[float], stopping: Stopping) -> Solution[np.ndarray]:
    return minimize(problem, np.array(start), stopping, Damping())


def test_rosenbrock_reaches_its_minimum_and_the_goal() -> None:
    found = solve(rosenbrock(), [-1.2, 1.0], Stopping(goal=1e-24, max_epochs=200))
    np.testing.assert_allclose(found.parameters, [1, 1], atol=1e-10)
    assert found.reason is StopReason.GOAL
    assert found.cost <= 1e-24
    assert found.epochs < 40


def test_curve_fit_agrees_with_scipy() -> None:
    problem = decay(noise=0.05)
    found = solve(problem, [1.0, 1.0, 0.0], Stopping(max_epochs=500))
    reference = least_squares(
        problem.residuals, [1.0, 1.0, 0.0], problem.jacobian, xtol=1e-15, ftol=1e-15, gtol=1e-15
    )
    np.testing.assert_allclose(found.parameters, reference.x, rtol=1e-7)
    assert found.cost == pytest.approx(reference.cost, rel=1e-12)
    assert found.reason in {StopReason.CEILING, StopReason.GRADIENT}


def test_gradient_stops_at_a_minimum_that_is_not_zero() -> None:
    found = solve(decay(noise=0.05), [1.0, 1.0, 0.0], Stopping(max_epochs=500, min_gradient=1e-6))
    assert found.reason is StopReason.GRADIENT


def test_epochs_are_accepted_steps_and_exhaust() -> None:
    found = solve(rosenbrock(), [-1.2, 1.0], Stopping(max_epochs=5))
    assert found.reason is StopReason.EPOCHS
    assert found.epochs == 5
    assert len(found.history.cost) == len(found.history.mu) == 6
    assert np.all(np.diff(found.history.cost) < 0)
    assert found.history.cost[-1] == found.cost == rosenbrock().cost(found.parameters)


def test_start_at_the_goal_takes_no_epoch() -> None:
    found = solve(rosenbrock(), [1.0, 1.0], Stopping())
    assert (found.reason, found.epochs, found.cost) == (StopReason.GOAL, 0, 0.0)


def test_ceiling_is_reached_when_no_step_helps() -> None:
    # The Jacobian has the wrong sign, so every step climbs.
    wrong = NumpyProblem(lambda x: x, lambda x: -np.eye(len(x)))
    found = solve(wrong, [1.0, 2.0], Stopping(max_epochs=10))
    assert (found.reason, found.epochs) == (StopReason.CEILING, 0)
    np.testing.assert_array_equal(found.parameters, [1.0, 2.0])
    assert found.mu > Damping().ceiling


def test_a_start_that_is_not_finite_is_a_result() -> None:
    assert solve(rosenbrock(), [np.nan, 1.0], Stopping()).reason is StopReason.NOT_FINITE


def test_damping_follows_the_rule_of_trainlm() -> None:
    # A linear problem: every step helps, so mu falls tenfold an epoch; the first step is known.
    A, b = np.array([[2.0, 0.0], [0.0, 0.5], [1.0, 1.0]]), np.array([1.0, 2.0, 3.0])
    problem = NumpyProblem(lambda x: A @ x - b, lambda _: A)
    found = solve(problem, [0.0, 0.0], Stopping(max_epochs=3))
    np.testing.assert_allclose(found.history.mu, [1e-3, 1e-4, 1e-5, 1e-6], rtol=1e-12)
    first = np.linalg.solve(A.T @ A + 1e-3 * np.eye(2), A.T @ b)
    assert found.history.cost[1] == pytest.approx(problem.cost(first), rel=1e-12)


def test_damping_rises_after_a_step_that_does_not_help() -> None:
    rejected = solve(rosenbrock(), [-1.2, 1.0], Stopping(max_epochs=2))
    ratios = np.round(np.log10(rejected.history.mu[1:] / rejected.history.mu[:-1]))
    assert set(ratios) != {-1.0}  # the first Rosenbrock step overshoots at mu = 1e-3


@pytest.mark.parametrize(
    "factors", [{"start": 0.0}, {"start": 1.0, "ceiling": 0.1}, {"increase": 1.0}, {"decrease": 0.0}]
)
def test_damping_that_cannot_work_is_refused(factors: dict[str, float]) -> None:
    with pytest.raises(InputError, match="Damping needs"):
        Damping(**factors)
