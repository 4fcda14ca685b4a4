"""Normal equations against differences of the residuals and a dense solution of the whole system."""

from dataclasses import replace

import numpy as np
import pytest

from labcal.calibrate.adjustment.dot_freedom import DatumConstraint, dot_freedom
from labcal.calibrate.adjustment.observations import Observations, observations_of
from labcal.calibrate.adjustment.problem import AdjustmentProblem
from labcal.calibrate.adjustment.schur import Reduced
from labcal.calibrate.adjustment.state import Freedom, Layout, Lenses, RigState
from labcal.cameras.camera import Camera
from labcal.correspond.detections import Detections
from labcal.optim.damping import Damping
from labcal.optim.levenberg_marquardt import minimize
from labcal.optim.robust import SQUARES, Huber, Loss
from labcal.optim.stopping import Stopping
from labcal.targets.grid import DotGrid

Case = tuple[Observations, RigState]


@pytest.fixture
def case(see: object, pair: dict[str, Camera], grid: DotGrid, poses: dict[str, np.ndarray]) -> Case:
    """Two views of two cameras, of which one misses some dots, a little off the truth."""
    poses = {name: poses[name] for name in list(poses)[1:3]}
    dots: Detections = see(pair, grid, poses)  # type: ignore[operator]
    dots = dots.where(~((dots.camera == "right") & (dots.index[:, 0] == 1)))
    random = np.random.default_rng(4)
    root = 0.05 * random.normal(size=(len(dots), 2, 2)) + 0.1 * np.eye(2)
    dots = replace(
        dots,
        position=dots.position + 0.5 * random.normal(size=dots.position.shape),
        covariance=root @ root.transpose(0, 2, 1),
    )
    observations = observations_of(dots, grid, ("left", "right"), tuple(poses))
    return observations, RigState(tuple(pair.values()), np.stack(list(poses.values())), grid.points())


def whitened(observations: Observations, state: RigState) -> np.ndarray:
    residual = state.residuals(observations)
    root = np.linalg.cholesky(observations.covariance)
    return np.linalg.solve(root, residual[:, :, None]).ravel()


def differences(observations: Observations, layout: Layout) -> np.ndarray:
    """Return the Jacobian, shared parameters first, by central differences."""
    views = len(layout.state.T_world_target)
    columns = []
    for number in range(layout.count + 6 * views):
        step = np.zeros(layout.count + 6 * views)
        step[number] = 1e-5
        ahead, behind = (
            whitened(observations, layout.stepped(s[: layout.count], s[layout.count :].reshape(views, 6)))
            for s in (step, -step)
        )
        columns.append((ahead - behind) / 2e-5)
    return np.stack(columns, axis=-1)


@pytest.mark.parametrize("free", ["lenses", "poses", "dots"])
def test_the_schur_complement_is_the_dense_solution(case: Case, grid: DotGrid, free: str) -> None:
    observations, state = case
    basis = np.zeros((3 * grid.count, 0))
    if free == "dots":
        basis = dot_freedom(state.dots, np.arange(grid.count) % 3 != 1, DatumConstraint.nothing(grid.count))[
            :, :20
        ]
    freedom = Freedom(Lenses.FIXED if free == "poses" else Lenses.FREE, basis)
    layout = Layout(state, freedom)
    J, r = differences(observations, layout), whitened(observations, state)
    problem = AdjustmentProblem(observations, freedom)
    found = problem.linearize(state)
    assert problem.cost(state) == pytest.approx(r @ r)
    gradient = np.concatenate([found.blocks.gradient.shared, found.blocks.gradient.view.ravel()])
    size = np.sqrt((J**2).sum(axis=0))
    np.testing.assert_allclose(gradient / size, J.T @ r / size, atol=1e-4)
    dense, *_ = np.linalg.lstsq(J / size, r, rcond=None)
    reduced = Reduced.of(found.blocks)
    assert reduced is not None
    step = reduced.solve(found.blocks.gradient, 0.0)
    assert step is not None
    step_size = np.concatenate([step.shared, step.view.ravel()]) * size
    np.testing.assert_allclose(step_size, dense, rtol=1e-3, atol=1e-3 * np.abs(dense).max())
    assert found.gradient_norm == pytest.approx(np.linalg.norm(J / size @ dense), rel=1e-4)
    covariance = np.linalg.inv((J / size).T @ (J / size))[: layout.count, : layout.count]
    sigma = np.sqrt(np.diagonal(found.shared_covariance())) * size[: layout.count]
    np.testing.assert_allclose(sigma, np.sqrt(np.diagonal(covariance)), rtol=1e-3)


def test_a_step_lowers_the_cost_and_settles_the_poses(case: Case, grid: DotGrid) -> None:
    observations, state = case
    problem = AdjustmentProblem(observations, Freedom(Lenses.FREE, np.zeros((3 * grid.count, 0))))
    stepped = problem.linearize(state).stepped(1e-3)
    assert stepped is not None
    assert problem.cost(stepped) < problem.cost(state)
    still = AdjustmentProblem(observations, Freedom(Lenses.FIXED, np.zeros((3 * grid.count, 0))))
    left = still.linearize(stepped).gradient_norm  # standard deviations
    assert left < 1e-3 * still.linearize(state).gradient_norm


def test_an_outlier_pulls_less_with_a_robust_loss(case: Case, grid: DotGrid) -> None:
    observations, state = case
    q = observations.q.copy()
    q[5] += 40.0
    spoilt = replace(observations, q=q)
    freedom = Freedom(Lenses.FIXED, np.zeros((3 * grid.count, 0)))

    def pulled(loss: Loss) -> float:
        ends = [
            minimize(
                AdjustmentProblem(dots, freedom, loss),
                state,
                Stopping(max_epochs=4, min_gradient=1e-3),
                Damping(),
            )
            for dots in (observations, spoilt)
        ]
        T, T_spoilt = (end.parameters.T_world_target for end in ends)
        return float(np.linalg.norm(T_spoilt[:, :3, 3] - T[:, :3, 3]))

    assert pulled(Huber()) < 0.2 * pulled(SQUARES)


def test_what_cannot_be_imaged_costs_infinitely(case: Case, grid: DotGrid) -> None:
    observations, state = case
    T = state.T_world_target.copy()
    T[0, 2, 3] = -500.0
    problem = AdjustmentProblem(observations, Freedom(Lenses.FREE, np.zeros((3 * grid.count, 0))))
    assert problem.cost(replace(state, T_world_target=T)) == float("inf")
