"""Methods taught with cameras whose rays are parallel: right points, or a lens that is named."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from labcal.cameras.camera import Camera
from labcal.cameras.triangulation import triangulation_limit
from labcal.errors import InputError
from labcal.estimators.bundle import Bundle
from labcal.estimators.dlt import Dlt
from labcal.estimators.hybrid import Hybrid
from labcal.evaluate.statistics import coverage
from labcal.geometry.poses import from_rotation_vector

SIZE, NOISE_PX, TESTED = (1280, 960), 0.02, 600
K = np.array([[12.0, 0.0, 639.5], [0.0, 12.1, 479.5], [0.0, 0.0, 1.0]])
DIST = np.array([-1.2e-5, 2e-9, 4e-6, -6e-6, -3e-13])


@dataclass(frozen=True)
class Stage:
    """Points that were taught and tested, mm, and their pixels."""

    X: np.ndarray
    Y: np.ndarray
    X_test: np.ndarray
    Y_test: np.ndarray
    limit_mm: float
    """RMS error with exactly known cameras."""


def stage(distortion: float) -> Stage:
    """Return four planes 13 mm apart before two cameras, 29 degrees between them."""
    T = from_rotation_vector(np.array([0.05, 0.5, -0.03]), np.zeros(3))
    T[:3, 3] = [0.0, 0.0, 500.0] - T[:3, 2] * 500.0
    left = Camera(K, "telecentric", distortion * DIST, np.eye(4), SIZE)
    cameras = (left, replace(left, K=K - np.diag([0.3, 0.2, 0.0]), T_cam_world=T))
    axes = (np.linspace(-30, 30, 12), np.linspace(-24, 24, 9), np.linspace(480, 520, 4))
    taught = np.array(np.meshgrid(*axes)).reshape(3, -1).T
    random = np.random.default_rng(0)
    tested = random.uniform([-28, -22, 485], [28, 22, 515], (TESTED, 3))
    X, X_test = (
        np.concatenate([camera.project(p).q for camera in cameras], axis=1)
        + NOISE_PX * random.standard_normal((len(p), 4))
        for p in (taught, tested)
    )
    bound = triangulation_limit(cameras, tested, np.tile(NOISE_PX**2 * np.eye(2), (TESTED, 2, 1, 1)))
    limit = float(np.sqrt(np.trace(bound, axis1=1, axis2=2).mean()))
    return Stage(X, taught, X_test, tested, limit)


def rms_mm(error: np.ndarray) -> float:
    return float(np.sqrt((error**2).sum(axis=1).mean()))


@pytest.mark.parametrize("method", [Bundle, Hybrid])
def test_with_the_lens_named_points_are_as_good_as_with_known_cameras(
    method: type[Bundle] | type[Hybrid],
) -> None:
    given = stage(1.0)
    fitted = method(lens="telecentric", image_sizes=(SIZE, SIZE)).fit(given.X, given.Y)
    covariance = np.tile(NOISE_PX**2 * np.eye(2), (TESTED, 2, 1, 1))
    points, stated = fitted.predict_with_covariance(given.X_test, covariance)
    error = points - given.Y_test
    assert rms_mm(error) < 1.1 * given.limit_mm
    assert abs(coverage(error, stated) - 0.95) < 3.0 * np.sqrt(0.95 * 0.05 / TESTED)


def test_the_direct_linear_transform_holds_them_without_distortion() -> None:
    given = stage(0.0)
    assert rms_mm(Dlt().fit(given.X, given.Y).predict(given.X_test) - given.Y_test) < 1.1 * given.limit_mm


@pytest.mark.parametrize("method", [Bundle, Hybrid])
def test_a_lens_whose_rays_meet_is_refused_and_the_right_one_is_named(
    method: type[Bundle] | type[Hybrid],
) -> None:
    given = stage(0.0)
    with pytest.raises(InputError, match=r"rays are parallel .* Choose the lens 'telecentric'"):
        method(lens="pinhole", image_sizes=(SIZE, SIZE)).fit(given.X, given.Y)


@pytest.mark.parametrize("distortion", [0.0, 1.0])
def test_the_choice_of_a_lens_says_so_too(distortion: float) -> None:
    given = stage(distortion)
    with pytest.raises(InputError, match=r"rays are parallel .* Choose the lens 'telecentric'"):
        Hybrid(image_sizes=(SIZE, SIZE)).fit(given.X, given.Y)
