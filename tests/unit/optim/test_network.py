import numpy as np
import pytest
import torch
from scipy.stats import kstest

from labcal.errors import InputError
from labcal.optim.damping import Damping
from labcal.optim.levenberg_marquardt import minimize_batch
from labcal.optim.network import Network
from labcal.optim.network_problem import NetworkProblem
from labcal.optim.nguyen_widrow import nguyen_widrow
from labcal.optim.stopping import Stopping

SIZES = [(4, 3), (4, 6, 3), (4, 5, 7, 3), (3, 4, 5, 6, 2), (1, 1, 1)]


def draw(sizes: tuple[int, ...], points: int) -> tuple[Network, torch.Tensor, torch.Tensor, torch.Tensor]:
    random = np.random.default_rng(5)
    network = Network(sizes)
    parameters = nguyen_widrow(network, random)
    inputs = torch.from_numpy(random.uniform(-1, 1, (points, sizes[0])))
    targets = torch.from_numpy(random.uniform(-1, 1, (points, sizes[-1])))
    return network, parameters, inputs, targets


def test_forward_agrees_with_torch_modules() -> None:
    network, parameters, inputs, _ = draw((4, 5, 7, 3), 11)
    modules: list[torch.nn.Module] = []
    for index, layer in enumerate(network.layers(parameters)):
        linear = torch.nn.Linear(layer.shape[1] - 1, layer.shape[0], dtype=torch.float64)
        linear.weight.data, linear.bias.data = layer[:, :-1], layer[:, -1]
        modules += [linear] if index == 2 else [linear, torch.nn.Tanh()]
    expected = torch.nn.Sequential(*modules)(inputs).detach()
    torch.testing.assert_close(network.forward(parameters, inputs)[1], expected, rtol=1e-14, atol=1e-14)


@pytest.mark.parametrize("sizes", SIZES)
def test_jacobian_agrees_with_autograd(sizes: tuple[int, ...]) -> None:
    network, parameters, inputs, _ = draw(sizes, 6)
    expected = torch.autograd.functional.jacobian(lambda p: network.forward(p, inputs)[1], parameters)
    torch.testing.assert_close(network.jacobian(parameters, inputs), expected, rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize("sizes", SIZES)
def test_derivatives_by_inputs_agree_with_autograd(sizes: tuple[int, ...]) -> None:
    network, parameters, inputs, _ = draw(sizes, 6)
    whole = torch.autograd.functional.jacobian(lambda x: network.forward(parameters, x)[1], inputs)
    expected = torch.stack([whole[point, :, point] for point in range(6)])
    torch.testing.assert_close(network.input_jacobian(parameters, inputs), expected, rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize("sizes", SIZES)
def test_normal_equations_agree_with_autograd(sizes: tuple[int, ...]) -> None:
    network, parameters, inputs, targets = draw(sizes, 9)

    def residuals(p: torch.Tensor) -> torch.Tensor:
        return (network.forward(p, inputs)[1] - targets).flatten()

    J, r = torch.autograd.functional.jacobian(residuals, parameters), residuals(parameters)
    system = NetworkProblem(network, inputs, targets).linearize([0], [parameters])
    lower = torch.from_numpy(system.matrices[0]).tril()
    torch.testing.assert_close(lower, (J.T @ J).tril(), rtol=1e-12, atol=1e-12)
    torch.testing.assert_close(torch.from_numpy(system.gradients[0]), J.T @ r, rtol=1e-12, atol=1e-12)
    assert system.gradient_norms[0] == pytest.approx(float((J.T @ r).abs().max()), rel=1e-12)
    step = torch.linalg.solve(J.T @ J + 0.1 * torch.eye(len(parameters), dtype=torch.float64), -J.T @ r)
    (stepped,) = system.stepped([0], [0.1])
    assert stepped is not None
    torch.testing.assert_close(stepped, parameters + step, rtol=1e-9, atol=1e-10)


@pytest.mark.parametrize("sizes", SIZES)
def test_members_of_a_batch_have_the_equations_that_they_have_alone(sizes: tuple[int, ...]) -> None:
    network, _, inputs, targets = draw(sizes, 9)
    starts = [nguyen_widrow(network, np.random.default_rng(seed)) for seed in range(3)]
    alone, batch = (NetworkProblem(network, inputs, targets, members) for members in (1, 3))
    system = batch.linearize([2, 0], [starts[2], starts[0]])
    for place, member in enumerate((2, 0)):
        expected = alone.linearize([0], [starts[member]])
        np.testing.assert_allclose(
            np.tril(system.matrices[place]), np.tril(expected.matrices[0]), rtol=1e-13, atol=1e-13
        )
        np.testing.assert_allclose(system.gradients[place], expected.gradients[0], rtol=1e-13, atol=1e-13)
    assert batch.costs([1], [starts[1]]) == pytest.approx(alone.costs([0], [starts[1]]), rel=1e-14)


def test_batches_end_where_each_member_would_alone() -> None:
    network, _, inputs, targets = draw((4, 6, 3), 40)
    starts = [nguyen_widrow(network, np.random.default_rng(seed)) for seed in range(4)]
    stopping = Stopping(goal=0.16, max_epochs=25)
    together = minimize_batch(NetworkProblem(network, inputs, targets, 4), starts, stopping, Damping())
    problem = NetworkProblem(network, inputs, targets)
    alone = [minimize_batch(problem, [start], stopping, Damping())[0] for start in starts]
    assert [run.epochs for run in together] == [run.epochs for run in alone]
    assert [run.reason for run in together] == [run.reason for run in alone]
    assert len({run.epochs for run in alone}) > 1  # some are dropped on the way
    for one, other in zip(together, alone, strict=True):
        torch.testing.assert_close(one.parameters, other.parameters, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(one.history.cost, other.history.cost, rtol=1e-9)


def test_a_singular_system_gives_no_step_when_undamped() -> None:
    network, parameters, inputs, targets = draw((4, 6, 3), 2)
    equations = NetworkProblem(network, inputs, targets).linearize([0], [parameters])
    assert equations.stepped([0], [-1e-6]) == [None]


def test_cost_is_the_mean_over_points_and_outputs() -> None:
    network, parameters, inputs, targets = draw((4, 6, 3), 8)
    errors = (network.forward(parameters, inputs)[1] - targets).numpy()
    (cost,) = NetworkProblem(network, inputs, targets).costs([0], [parameters])
    assert cost == pytest.approx(np.sum(errors**2) / 24, rel=1e-14)


def test_parameter_count_of_the_paper() -> None:
    assert Network((4, 20, 30, 3)).parameter_count == 823


@pytest.mark.parametrize("sizes", [(4,), (4, 0, 3)])
def test_networks_without_neurons_are_refused(sizes: tuple[int, ...]) -> None:
    with pytest.raises(InputError, match="no empty layer"):
        Network(sizes)


def uniform_within(values: torch.Tensor, bound: float) -> bool:
    """Tell whether values can be uniform on plus and minus a bound (Kolmogorov and Smirnov, 4 sigma)."""
    return kstest(values.numpy(), "uniform", (-bound, 2 * bound)).pvalue > 6e-5


def test_nguyen_widrow_lengths_and_ranges() -> None:
    network = Network((4, 200, 300, 3))
    first, second, last = network.layers(nguyen_widrow(network, np.random.default_rng(1)))
    for layer, inputs in ((first, 4), (second, 200)):
        length = 0.7 * len(layer) ** (1 / inputs)
        lengths = layer[:, :-1].norm(dim=1)
        torch.testing.assert_close(lengths, torch.full_like(lengths, length))
        assert uniform_within(layer[:, -1], length)
        # Directions favour no side: the mean of so many unit vectors is short.
        assert float((layer[:, :-1] / length).mean(dim=0).norm()) < 4 / len(layer) ** 0.5
    assert uniform_within(last.flatten(), 1.0)


def test_nguyen_widrow_neurons_bend_inside_the_inputs_range() -> None:
    # What the method is for: each neuron's plane of zero activation cuts the cube of inputs or nearly so.
    network = Network((4, 20, 3))
    layer = network.layers(nguyen_widrow(network, np.random.default_rng(2)))[0]
    distance = layer[:, -1].abs() / layer[:, :-1].norm(dim=1)
    assert float(distance.max()) <= 1 + 1e-12


def test_nguyen_widrow_is_the_same_for_the_same_generator() -> None:
    network = Network((4, 20, 30, 3))
    one, same, other = (nguyen_widrow(network, np.random.default_rng(seed)) for seed in (1, 1, 2))
    assert torch.equal(one, same)
    assert not torch.equal(one, other)
