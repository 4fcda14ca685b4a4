"""Errors of a stage are random effects beside a residual field, and no part of it."""

import numpy as np
import pytest
from scipy.optimize import approx_fprime
from scipy.spatial.transform import Rotation

from labcal import Camera
from labcal.calibrate.resection.resected import resect
from labcal.estimators.gp_field.fitted_camera import FittedCamera
from labcal.estimators.gp_field.learning import fitted_camera
from labcal.estimators.gp_field.restricted import NO_FIELD, RestrictedLikelihood
from labcal.estimators.gp_field.stage_moves import StageMoves, likeliest_moves
from labcal.geometry.poses import look_at, pose, transform

SIZE = (640, 480)
NOISE_PX, SIGMA_MM, SIGMA_DEG = 0.03, 0.05, 0.03
K = [[900.0, 0.0, 320.0], [0.0, 900.0, 240.0], [0.0, 0.0, 1.0]]
EYE, MIDDLE = np.array([40.0, 20.0, 0.0]), np.array([0.0, 0.0, 500.0])
CAMERA = Camera(K, "pinhole", [0] * 5, look_at(EYE, MIDDLE, np.array([0, -1.0, 0])), SIZE)
BOARD = np.stack(np.meshgrid(np.linspace(-90, 90, 8), np.linspace(-70, 70, 6)), -1).reshape(-1, 2)
POSES = {f"v{i}": pose(np.eye(3), np.array([0.0, 0.0, z])) for i, z in enumerate(np.linspace(430, 570, 6))}
VIEW = np.repeat(list(POSES), len(BOARD))


def on_stage(seed: int, bend_px: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Return pixels, and points at a stage's readings, which are off; a wavy window bends the pictures."""
    rng = np.random.default_rng(seed)
    local = np.column_stack([BOARD, np.zeros(len(BOARD))])
    pixels, points = [], []
    for T in POSES.values():
        turn = Rotation.from_rotvec(np.radians(SIGMA_DEG) * rng.standard_normal(3))
        true = pose(turn.as_matrix() @ T[:3, :3], T[:3, 3] + SIGMA_MM * rng.standard_normal(3))
        pixels.append(CAMERA.project(transform(true, local)).q)
        points.append(transform(T, local))
    q = np.concatenate(pixels)
    q = q + bend_px * np.sin(q[:, ::-1] / 45.0) + NOISE_PX * rng.standard_normal(q.shape)
    return q, np.concatenate(points)


def moves(p: np.ndarray) -> StageMoves:
    return StageMoves.of(VIEW, p, POSES, SIGMA_MM, SIGMA_DEG)


def fitted(q: np.ndarray, p: np.ndarray, stage: StageMoves | None) -> FittedCamera:
    return fitted_camera(resect("hybrid", q, p, CAMERA), q, p, stage)


@pytest.mark.parametrize("seed", range(2))
def test_a_field_does_not_explain_errors_of_the_stage(seed: int) -> None:
    q, p = on_stage(seed)
    assert fitted(q, p, None).fitted is not None
    assert fitted(q, p, moves(p)).fitted is None


@pytest.mark.slow
def test_a_field_beside_errors_of_the_stage_is_found_as_it_is() -> None:
    q, p = on_stage(1, bend_px=0.5)
    rng = np.random.default_rng(0)
    asked = rng.uniform([-60, -50, 440], [60, 50, 560], (300, 3))
    true = CAMERA.project(asked).q
    true = true + 0.5 * np.sin(true[:, ::-1] / 45.0)
    off = {}
    for name, stage in (("with", moves(p)), ("without", None)):
        camera = fitted(q, p, stage)
        assert camera.fitted is not None
        assert name == "without" or camera.noise_px == pytest.approx(NOISE_PX, rel=0.1)
        off[name] = np.sqrt(((camera.project(asked) - true) ** 2).mean())
    assert off["with"] < off["without"]


def test_the_likelihood_is_that_of_the_whole_covariance() -> None:
    rng = np.random.default_rng(3)
    n, free, effects, noise = 30, 4, 6, 0.2
    x, r = rng.uniform(0, 1, (n, 3)), rng.standard_normal((n, 2))
    J, B = rng.standard_normal((n, 2, free)), 0.3 * rng.standard_normal((n, 2, effects))
    likelihood = RestrictedLikelihood(x, r, J, by_stage=B, noise_px=noise)

    def expected(logs: np.ndarray) -> float:
        flat = B.reshape(2 * n, -1)
        V = np.kron(likelihood.covariance(logs), np.eye(2)) + flat @ flat.T / noise**2
        j = J.reshape(2 * n, -1)
        j = j / np.linalg.norm(j, axis=0)
        inverse = np.linalg.inv(V)
        P = inverse - inverse @ j @ np.linalg.solve(j.T @ inverse @ j, j.T @ inverse)
        freedom = 2 * n - free
        variance = r.ravel() @ P @ r.ravel() / freedom
        logdet = np.linalg.slogdet(V)[1] + np.linalg.slogdet(j.T @ inverse @ j)[1]
        return float(0.5 * freedom * np.log(variance) + 0.5 * logdet)

    places = [np.log([5.0, 0.3, 1.0]), np.log([100.0, 0.6, 0.5])]
    gap = likelihood.cost(places[0]) - likelihood.cost(places[1])
    assert gap == pytest.approx(expected(places[0]) - expected(places[1]), abs=1e-8)
    assert likelihood.cost(NO_FIELD) - likelihood.cost(places[1]) == pytest.approx(
        expected(NO_FIELD) - expected(places[1]), abs=1e-8
    )
    _, slopes = likelihood.cost_and_slopes(places[0])
    np.testing.assert_allclose(slopes, approx_fprime(places[0], likelihood.cost, 1e-6), atol=1e-4)


def test_errors_of_the_stage_are_found_but_for_what_a_camera_can_take_up() -> None:
    q, p = on_stage(2)
    camera = resect("hybrid", q, p, CAMERA)
    by_camera, by_stage = camera.placed.seen(p).by_camera, moves(p).pixels(camera.camera, p)
    root = NOISE_PX * np.eye(len(p))
    found = likeliest_moves(root, -camera.residual, by_camera, by_stage)
    left = resect("hybrid", q - found, p, CAMERA)
    assert camera.sigma_px > 1.2 * NOISE_PX
    assert left.sigma_px == pytest.approx(NOISE_PX, rel=0.08)
