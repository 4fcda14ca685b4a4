from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import torch
from scipy.stats import chi2

from labcal.errors import InputError
from labcal.estimators.dlt import Dlt
from labcal.estimators.networks import ray_net
from labcal.estimators.networks.ray_net import RayNet
from labcal.estimators.networks.ray_problem import RayProblem
from labcal.estimators.ray_field import RayFrame
from labcal.optim.bayesian_training import BayesianSolution, train_by_evidence
from labcal.optim.damping import Damping

View = Callable[[np.ndarray], np.ndarray]
SIGMA_PX = 0.1


def noisy(X: np.ndarray, seed: int) -> np.ndarray:
    return X + SIGMA_PX * np.random.default_rng(seed).standard_normal(X.shape)


def rms(errors: np.ndarray) -> float:
    return float(np.sqrt((errors**2).sum(axis=1).mean()))


def test_rays_of_two_cameras_meet_about_as_well_as_noise_allows(
    stereo: View, volume: np.ndarray, other_volume: np.ndarray
) -> None:
    seen = noisy(stereo(other_volume), 2)
    found = RayNet(hidden=(6, 6)).fit(noisy(stereo(volume), 1), volume)
    covariance = np.broadcast_to(SIGMA_PX**2 * np.eye(2), (len(seen), 2, 2, 2))
    points, stated = found.predict_with_covariance(seen, covariance)
    # Exact cameras: the limit.
    limit = rms(Dlt().fit(stereo(volume), volume).predict(seen) - other_volume)
    errors = points - other_volume
    assert rms(errors) < 1.1 * limit
    distance = np.einsum("ni,nij,nj->n", errors, np.linalg.inv(stated), errors)
    assert 0.85 < float((distance < chi2(3).ppf(0.95)).mean()) < 0.99
    # In pixels: one residual along each of two directions.
    assert found.rms_px_ == pytest.approx(np.sqrt(2) * SIGMA_PX, rel=0.15)


def test_bent_pictures_and_three_cameras(
    three_cameras: View, volume: np.ndarray, other_volume: np.ndarray
) -> None:
    def bent(points: np.ndarray) -> np.ndarray:
        q = three_cameras(points)
        return q + 2.0 * np.sin(q / 60.0)

    found = RayNet(hidden=(6, 6), max_epochs=200, restarts=1).fit(bent(volume), volume)
    straight = Dlt().fit(bent(volume), volume).predict(bent(other_volume)) - other_volume
    assert rms(found.predict(bent(other_volume)) - other_volume) < 0.5 * rms(straight)


def test_each_camera_keeps_its_own_best_start(
    monkeypatch: pytest.MonkeyPatch, stereo: View, volume: np.ndarray
) -> None:
    X = noisy(stereo(volume), 1)

    def fitted(restarts: int) -> RayNet:
        return RayNet(hidden=(4, 4), max_epochs=24, restarts=restarts).fit(X, volume)

    alone = fitted(1)
    first, second = RayNet(hidden=(4, 4), restarts=1)._starts(2)
    hopeless = torch.full_like(first, 40.0)  # every neuron saturated
    given = [hopeless, second, first, hopeless]
    monkeypatch.setattr(RayNet, "_starts", lambda self, cameras: given[: cameras * self.restarts])
    raced = fitted(2)
    assert raced.parameters_.tobytes() == alone.parameters_.tobytes()
    assert raced.weight_factors_.tobytes() == alone.weight_factors_.tobytes()


def test_of_two_trainings_the_one_that_foretells_less_error_is_kept(
    monkeypatch: pytest.MonkeyPatch, stereo: View, volume: np.ndarray
) -> None:
    trained: list[list[BayesianSolution]] = []

    def contradicted(
        problem: RayProblem, starts: list[torch.Tensor], epochs: int, damping: Damping
    ) -> list[BayesianSolution]:
        """Train, and say that the evidence is the greater, the greater the error to expect."""
        solutions = []
        for one in train_by_evidence(problem, starts, epochs, damping):
            expected = one.evidence.expected_square(problem.residual_count)
            solutions.append(replace(one, evidence=replace(one.evidence, log_evidence=expected)))
        trained.append(solutions)
        return solutions

    monkeypatch.setattr(ray_net, "train_by_evidence", contradicted)
    found = RayNet(hidden=(4, 4), max_epochs=12, restarts=1).fit(noisy(stereo(volume), 1), volume)
    for own, pair in zip(found.parameters_, zip(*trained, strict=True), strict=True):
        better = min(pair, key=lambda one: one.evidence.log_evidence)
        assert own.tobytes() == better.parameters.numpy().tobytes()


def test_frames_look_along_the_view_and_misses_vanish_on_rays(stereo: View, volume: np.ndarray) -> None:
    q = stereo(volume)[:, :2]
    frame = RayFrame.of(volume, q)
    np.testing.assert_allclose(frame.axes @ frame.axes.T, np.eye(3), atol=1e-12)
    view = np.array([1000.0, 1000.0, 200.0]) - np.array([600.0, 1000.0, 2100.0])
    assert abs(frame.axes[2] @ view) > 0.97 * np.linalg.norm(view)
    crossings = np.random.default_rng(5).uniform(-1, 1, (40, 4))
    near, far = frame.ends(crossings)
    share = np.random.default_rng(6).uniform(-0.5, 1.5, (40, 1))
    on_ray = (1 - share) * near + share * far
    np.testing.assert_allclose(frame.distances(crossings, on_ray), 0.0, atol=1e-9)
    np.testing.assert_allclose(frame.share(on_ray), share[:, 0], atol=1e-12)
    # The derivative by the point, against differences.
    step = np.array([0.3, -0.2, 0.5])
    moved = frame.distances(crossings, on_ray + step) - frame.distances(crossings, on_ray)
    np.testing.assert_allclose(moved, frame.distance_slopes(crossings) @ step, atol=1e-9)


def test_what_rays_cannot_be_learned_from_is_refused(
    stereo: View, volume: np.ndarray, plane: np.ndarray
) -> None:
    with pytest.raises(InputError, match=r"ray-net: all 300 dots lie on one plane"):
        RayNet().fit(stereo(plane), plane)
    with pytest.raises(InputError, match="ray-net: restarts must be 1 or more, but is 0"):
        RayNet(restarts=0).fit(stereo(volume), volume)
    with pytest.raises(InputError, match="one camera, but rays meet"):
        RayNet().fit(stereo(volume)[:, :2], volume)
    with pytest.raises(InputError, match="Y has 2 columns"):
        RayNet().fit(stereo(volume), volume[:, :2])
    with pytest.raises(InputError, match="hidden not empty"):
        RayNet(hidden=()).fit(stereo(volume), volume)
    with pytest.raises(InputError, match="5 points were given"):
        RayNet().fit(stereo(volume[:5]), volume[:5])
    blind = np.hstack([stereo(volume)[:, :2], np.full((len(volume), 2), 100.0)])
    with pytest.raises(InputError, match="ray-net: a camera sees all dots at the same pixel"):
        RayNet().fit(blind, volume)
