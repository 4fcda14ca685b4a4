"""Successive halving of toy runs with known courses, and of small networks."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import pytest
import torch

from labcal.optim.bayesian_training import train_by_evidence
from labcal.optim.damping import Damping
from labcal.optim.levenberg_marquardt import minimize_batch
from labcal.optim.lm_state import LevenbergMarquardtState
from labcal.optim.network import Network
from labcal.optim.network_problem import NetworkProblem
from labcal.optim.nguyen_widrow import nguyen_widrow
from labcal.optim.solution import Solution
from labcal.optim.stopping import Stopping, StopReason
from labcal.optim.successive_halving import FIRST_MILESTONE, SuccessiveHalving


@dataclass(frozen=True)
class State:
    """A point of a toy run: its start's number, and the epochs since."""

    start: int
    epoch: int


@dataclass(frozen=True)
class Stepping:
    states: Sequence[State]

    @property
    def gradient_norms(self) -> list[float]:
        return [1.0 for _ in self.states]

    def stepped(self, places: Sequence[int], mus: Sequence[float]) -> list[State | None]:
        return [
            State(self.states[k].start, self.states[k].epoch + 1) for k, _ in zip(places, mus, strict=True)
        ]


@dataclass(frozen=True)
class Courses:
    """A batch whose costs fall as written down: a row a start, a column an epoch."""

    costs_of: np.ndarray

    def costs(self, members: Sequence[int], parameters: Sequence[State]) -> list[float]:
        assert [state.start for state in parameters] == list(members)
        return [float(self.costs_of[state.start, state.epoch]) for state in parameters]

    def linearize(self, members: Sequence[int], parameters: Sequence[State]) -> Stepping:
        assert [state.start for state in parameters] == list(members)
        return Stepping(parameters)


def halved(costs: np.ndarray, halving: SuccessiveHalving | None, goal: float = 0.0) -> list[Solution[State]]:
    starts = [State(number, 0) for number in range(len(costs))]
    stopping = Stopping(goal=goal, max_epochs=costs.shape[1] - 1)
    return minimize_batch(Courses(costs), starts, stopping, Damping(), halving)


def straight(slopes: Sequence[float], epochs: int = 50) -> np.ndarray:
    """Return courses from 100 down by so much an epoch, so that the steepest is always ahead."""
    return 100.0 - np.outer(slopes, np.arange(epochs + 1))


@dataclass(frozen=True)
class Witness(SuccessiveHalving):
    """A halving that writes down how many runs are left after every epoch, and why the others stopped."""

    left: list[int] = field(default_factory=list)
    reasons: list[StopReason | None] = field(default_factory=list)

    def prune(self, runs: Sequence[LevenbergMarquardtState[State]], losses: Sequence[float]) -> None:
        super().prune(runs, losses)
        self.reasons[:] = [run.reason for run in runs]
        self.left.append(self.reasons.count(None))


def test_half_is_given_up_at_every_doubling_and_the_best_is_kept() -> None:
    halving = Witness([range(8)])
    (best,) = halved(straight([1.0, 0.4, 1.2, 0.7, 1.9, 0.2, 1.5, 0.9]), halving)
    assert (best.parameters.start, best.epochs, best.cost) == (4, 50, 5.0)
    five, ten, twenty = (FIRST_MILESTONE * factor for factor in (1, 2, 4))
    expected = [8] * (five - 1) + [4] * (ten - five) + [2] * (twenty - ten) + [1] * (50 - twenty) + [0]
    assert halving.left == expected
    assert [reason is StopReason.PRUNED for reason in halving.reasons] == [k != 4 for k in range(8)]


def test_the_better_half_is_that_of_the_milestone() -> None:
    # The last start is by far the best in the end, but the worst at the first milestone.
    costs = straight([1.0, 1.1, 1.2, 0.1])
    costs[3, 10:] -= 60.0
    assert halved(costs, SuccessiveHalving([range(4)]))[0].parameters.start == 2
    assert halved(costs, SuccessiveHalving([range(4)], first_milestone=12))[0].parameters.start == 3


def test_groups_keep_their_own() -> None:
    # Every run of the second group is worse than every run of the first.
    courses = straight([1.5, 0.2, 1.6, 0.3, 1.4, 0.1])
    found = halved(courses, SuccessiveHalving([range(0, 6, 2), range(1, 6, 2)]))
    assert [one.parameters.start for one in found] == [2, 3]


def test_as_many_as_are_wanted_are_kept_in_the_order_of_their_starts() -> None:
    halving = Witness([range(6)], keep=3)
    found = halved(straight([0.3, 1.0, 0.2, 1.5, 0.1, 1.2]), halving)
    assert [one.parameters.start for one in found] == [1, 3, 5]
    assert min(halving.left[:-1]) == 3


def test_the_goal_ends_all_of_a_group() -> None:
    courses = straight([1.0, 4.0, 2.0, 3.0])
    halving = Witness([range(2), range(2, 4)])
    first, second = halved(courses, halving, goal=90.0)
    assert (first.parameters.start, first.epochs, first.reason) == (1, 3, StopReason.GOAL)
    assert (second.parameters.start, second.epochs, second.reason) == (3, 4, StopReason.GOAL)
    assert halving.reasons[::2] == [StopReason.PRUNED] * 2
    assert halving.left == [4, 4, 2, 0]


def test_a_goal_that_one_reaches_does_not_end_those_that_are_wanted_too() -> None:
    found = halved(straight([1.0, 4.0, 2.0]), SuccessiveHalving([range(3)], keep=2), goal=90.0)
    assert [(one.parameters.start, one.epochs) for one in found] == [(1, 3), (2, 5)]


def test_a_loss_that_is_nan_is_worst() -> None:
    courses = straight([1.0, 0.5, 0.8])
    courses[0, 0] = np.nan
    assert halved(courses, SuccessiveHalving([range(3)]))[0].parameters.start == 2


def test_without_a_race_all_go_to_their_end() -> None:
    assert [one.epochs for one in halved(straight([1.0, 2.0, 1.5]), None)] == [50, 50, 50]


def network_batch(members: int) -> tuple[NetworkProblem, list[torch.Tensor]]:
    network = Network((3, 5, 2))
    random = np.random.default_rng(4)
    inputs = random.uniform(-1, 1, (60, 3))
    targets = np.sin(2.0 * inputs[:, :2]) + 0.02 * random.standard_normal((60, 2))
    starts = [nguyen_widrow(network, np.random.default_rng(seed)) for seed in range(members)]
    problem = NetworkProblem(network, torch.from_numpy(inputs), torch.from_numpy(targets), members)
    return problem, starts


def test_one_start_has_the_bytes_that_it_has_without_a_race() -> None:
    problem, starts = network_batch(1)
    halving = SuccessiveHalving([range(1)])
    stopping = Stopping(max_epochs=30)
    plain = [minimize_batch(problem, starts, stopping, Damping(), given)[0] for given in (None, halving)]
    assert plain[0].parameters.numpy().tobytes() == plain[1].parameters.numpy().tobytes()
    assert (plain[0].epochs, plain[0].reason) == (plain[1].epochs, plain[1].reason)
    ruled = [train_by_evidence(problem, starts, 30, Damping(), given)[0] for given in (None, halving)]
    assert ruled[0].parameters.numpy().tobytes() == ruled[1].parameters.numpy().tobytes()
    assert ruled[0].factor.tobytes() == ruled[1].factor.tobytes()


def test_training_by_evidence_keeps_the_run_that_it_would_be_alone() -> None:
    problem, starts = network_batch(5)
    (best,) = train_by_evidence(problem, starts, 40, Damping(), SuccessiveHalving([range(5)]))
    alone = train_by_evidence(problem, starts, 40, Damping())
    distances = [float((best.parameters - one.parameters).abs().max()) for one in alone]
    same = alone[int(np.argmin(distances))]
    assert min(distances) < 1e-6
    np.testing.assert_allclose(best.factor, same.factor, rtol=1e-5, atol=1e-5 * np.abs(same.factor).max())
    expected = [one.evidence.expected_square(problem.residual_count) for one in alone]
    assert expected[int(np.argmin(distances))] <= np.median(expected)
    assert int(np.argmin(distances)) != 0  # the first would do without any halving


def test_the_square_to_expect_is_that_of_leaving_points_out() -> None:
    # Without hidden layers and with little decay: the mean square of residuals each left out of the fit.
    random = np.random.default_rng(2)
    inputs = random.uniform(-1, 1, (80, 4))
    outputs = inputs @ np.array([1.0, -0.5, 0.8, 0.3]) + 0.1 * random.standard_normal(80)
    network = Network((4, 1))
    problem = NetworkProblem(network, torch.from_numpy(inputs), torch.from_numpy(outputs[:, None]))
    start = nguyen_widrow(network, np.random.default_rng(1))
    (found,) = train_by_evidence(problem, [start], 60, Damping())
    A = np.column_stack((inputs, np.ones(80)))
    hat = A @ np.linalg.pinv(A)
    left_out = (outputs - hat @ outputs) / (1.0 - np.diag(hat))
    assert found.evidence.expected_square(80) == pytest.approx(float(np.mean(left_out**2)), rel=0.02)
