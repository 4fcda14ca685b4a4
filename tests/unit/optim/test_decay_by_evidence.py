"""The evidence of networks without hidden layers, which is known in closed form."""

import numpy as np
import pytest
import torch
from scipy.stats import chi2, multivariate_normal

from labcal.optim.bayesian_training import BayesianSolution, train_by_evidence
from labcal.optim.damping import Damping
from labcal.optim.decay_by_evidence import Evidence
from labcal.optim.network import Network
from labcal.optim.network_problem import NetworkProblem
from labcal.optim.nguyen_widrow import nguyen_widrow
from labcal.optim.stopping import StopReason

POINTS, SIGMA = 200, 0.05


def linear_data(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return inputs, of which two of four do nothing, and one noisy output."""
    random = np.random.default_rng(seed)
    inputs = random.uniform(-1, 1, (POINTS, 4))
    outputs = inputs @ np.array([1.0, -0.5, 0.0, 0.0]) + SIGMA * random.standard_normal(POINTS)
    return inputs, outputs[:, None]


def trained(sizes: tuple[int, ...], members: int = 1, max_epochs: int = 200) -> list[BayesianSolution]:
    network = Network(sizes)
    inputs, outputs = linear_data(3)
    problem = NetworkProblem(network, torch.from_numpy(inputs), torch.from_numpy(outputs), members)
    starts = [nguyen_widrow(network, np.random.default_rng(seed)) for seed in range(members)]
    return train_by_evidence(problem, starts, max_epochs, Damping())


def test_a_linear_network_has_the_evidence_of_its_gaussian() -> None:
    inputs, outputs = linear_data(1)
    problem = NetworkProblem(Network((4, 1)), torch.from_numpy(inputs), torch.from_numpy(outputs))
    alpha, beta = 3.0, 150.0
    A = np.column_stack((inputs, np.ones(POINTS)))
    hessian = beta * A.T @ A + alpha * np.eye(5)
    best = torch.from_numpy(np.linalg.solve(hessian, beta * A.T @ outputs[:, 0]))
    (square,) = problem.squares([0], [best])
    found = Evidence(alpha, beta, 5.0, 0.0).updated(problem.linearize([0], [best]), 0, square, POINTS)
    # The weights are N(0, 1 / (2 alpha)), the noise is N(0, 1 / (2 beta)).
    covariance = np.eye(POINTS) / (2 * beta) + A @ A.T / (2 * alpha)
    expected = multivariate_normal(np.zeros(POINTS), covariance).logpdf(outputs[:, 0])
    assert found.log_evidence == pytest.approx(expected, abs=1e-6)
    eigenvalues = beta * np.linalg.eigvalsh(A.T @ A)
    gamma = np.sum(eigenvalues / (eigenvalues + alpha))
    assert found.effective_parameters == pytest.approx(gamma, rel=1e-10)
    assert found.alpha == pytest.approx(gamma / (2 * float(best @ best)), rel=1e-10)
    assert found.beta == pytest.approx((POINTS - gamma) / (2 * square), rel=1e-10)


def test_the_noise_is_found_and_spare_weights_are_not_used() -> None:
    (found,) = trained((4, 10, 1))
    assert found.reason is StopReason.SETTLED
    assert found.evidence.effective_parameters < 30  # of 61
    statistic = POINTS * (1 / (2 * found.evidence.beta)) / SIGMA**2
    assert 0.001 < chi2(POINTS - found.evidence.effective_parameters).cdf(statistic) < 0.999


def test_the_factor_is_that_of_the_weights_precision() -> None:
    (found,) = trained((4, 1))
    inputs, _ = linear_data(3)
    A = np.column_stack((inputs, np.ones(POINTS)))
    precision = found.evidence.beta * A.T @ A + found.evidence.alpha * np.eye(5)
    np.testing.assert_allclose(found.factor @ found.factor.T, precision, rtol=1e-9, atol=1e-9)


def test_members_end_where_they_would_alone() -> None:
    first, _ = trained((4, 5, 1), members=2)
    (alone,) = trained((4, 5, 1))
    assert (first.epochs, first.reason) == (alone.epochs, alone.reason)
    torch.testing.assert_close(first.parameters, alone.parameters, rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(first.history, alone.history, rtol=1e-6)


def test_epochs_exhaust() -> None:
    (found,) = trained((4, 5, 1), max_epochs=3)
    assert (found.reason, found.epochs, len(found.history)) == (StopReason.EPOCHS, 3, 4)
