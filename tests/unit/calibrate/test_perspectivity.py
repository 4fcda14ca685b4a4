"""Whether rays meet: the score test beside parallel rays, on dots in space and on a target in the hand."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from labcal.calibrate.calibrated import calibrated
from labcal.calibrate.lens_start import start_from_pictures
from labcal.calibrate.parallel_views import refuse_parallel_views
from labcal.calibrate.perspectivity import Perspectivity, Sight
from labcal.calibrate.resection.lens_choice import camera_of_lens
from labcal.calibrate.resection.resected import resect
from labcal.cameras.camera import Camera
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.geometry.poses import from_rotation_vector, transform
from labcal.targets.catalogue import load_target

See = Callable[..., Detections]
SIZE, SCALE, NOISE_PX = (1280, 960), 12.0, 0.02
MIDDLE = (639.5, 479.5)
TARGET = load_target("rings-10x8")


def parallel_camera() -> Camera:
    K = np.array([[SCALE, 0.0, MIDDLE[0]], [0.0, SCALE, MIDDLE[1]], [0.0, 0.0, 1.0]])
    return Camera(K, "telecentric", np.zeros(5), np.eye(4), SIZE)


def long_camera(distance_mm: float) -> Camera:
    """Return a pinhole that images the plane at a distance to the scale of the parallel one."""
    f = SCALE * distance_mm
    K = np.array([[f, 0.0, MIDDLE[0]], [0.0, f, MIDDLE[1]], [0.0, 0.0, 1.0]])
    return Camera(K, "pinhole", np.zeros(5), np.eye(4), SIZE)


def volume(distance_mm: float) -> np.ndarray:
    axes = np.linspace(-40, 40, 7), np.linspace(-30, 30, 6), np.linspace(-20, 20, 4) + distance_mm
    return np.array(np.meshgrid(*axes)).reshape(3, -1).T


def measured(camera: Camera, p: np.ndarray, seed: int) -> np.ndarray:
    return camera.project(p).q + NOISE_PX * np.random.default_rng(seed).standard_normal((len(p), 2))


def standardised(distance_mm: float, seed: int) -> float:
    """Return the perspectivity of a long camera's pixels, less the true one, in standard deviations."""
    p = volume(distance_mm)
    q = measured(long_camera(distance_mm), p, seed)
    found = Perspectivity.of(parallel_camera(), [Sight(q, p - [0.0, 0.0, distance_mm])])
    return float(found.value[0] - 1.0 / distance_mm) / float(found.sigma[0])


def test_it_is_the_inverse_distance_with_its_standard_deviation() -> None:
    square = sum(standardised(1e5, seed) ** 2 for seed in range(60))
    assert chi2.ppf(0.001, 60) < square < chi2.ppf(0.999, 60)


@pytest.mark.parametrize(("distance_mm", "none"), [(1e9, True), (2e4, False), (2e3, False)])
def test_rays_that_meet_within_the_bounds_are_not_called_parallel(distance_mm: float, none: bool) -> None:  # noqa: FBT001
    p = volume(distance_mm)
    q = measured(long_camera(distance_mm), p, 3)
    found = Perspectivity.of(parallel_camera(), [Sight(q, p - [0.0, 0.0, distance_mm])])
    assert found.is_none(parallel_camera()) is none


def test_dots_that_do_not_tell_are_not_called_parallel() -> None:
    p = volume(1e9)[::24]
    q = measured(long_camera(1e9), p, 5) + 3.0 * np.random.default_rng(6).standard_normal((len(p), 2))
    found = Perspectivity.of(parallel_camera(), [Sight(q, p - [0.0, 0.0, 1e9])])
    assert not found.is_none(parallel_camera())


def test_a_long_lens_is_resected_as_before() -> None:
    p = volume(3e3)
    found = resect("bundle", measured(long_camera(3e3), p, 1), p, camera_of_lens("pinhole", SIZE, None))
    sigma = np.sqrt(np.diagonal(found.covariance))[6]
    assert abs(found.camera.intrinsics[0] - SCALE * 3e3) < 3.0 * sigma
    assert found.sigma_px < 1.2 * NOISE_PX


def poses(distance_mm: float) -> dict[str, np.ndarray]:
    """Return ten places of a target at a distance, tilted every way."""
    random, middle, found = np.random.default_rng(8), TARGET.points().mean(axis=0), {}
    for number in range(10):
        T = from_rotation_vector(random.normal(0.0, 0.3, 3), np.zeros(3))
        T[:3, :3] = np.diag([1.0, -1.0, -1.0]) @ T[:3, :3]
        away = random.uniform([-20, -15, distance_mm - 12], [20, 15, distance_mm + 12])
        T[:3, 3] = away - transform(T, middle)
        found[f"pose-{number}"] = T
    return found


def held(centroids: See, camera: Camera, distance_mm: float) -> Detections:
    dots = centroids({"left": camera}, TARGET, poses(distance_mm))
    noise = NOISE_PX * np.random.default_rng(2).standard_normal(dots.position.shape)
    covariance = np.tile(NOISE_PX**2 * np.eye(2), (len(noise), 1, 1))
    return replace(dots, position=dots.position + noise, covariance=covariance)


@pytest.mark.parametrize("lens", ["auto", "brown5", "pinhole"])
def test_a_target_in_the_hand_names_the_lens_that_suits(centroids: See, lens: str) -> None:
    dots = held(centroids, parallel_camera(), 500.0)
    with pytest.raises(InputError, match=r"'left': the rays are parallel .* Choose the lens 'telecentric'"):
        calibrated(dots, TARGET, lens)


def test_a_target_far_before_a_long_lens_is_not_refused(centroids: See) -> None:
    distance = 2.5e3
    dots = held(centroids, long_camera(distance), distance)
    pictures = dots.by_view()
    first = start_from_pictures(pictures, TARGET, "pinhole").camera
    assert first.intrinsics[0] > 10.0 * SIZE[0]  # so long that it is tested
    refuse_parallel_views(pictures, TARGET, first, 2)
