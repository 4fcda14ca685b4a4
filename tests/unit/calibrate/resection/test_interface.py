"""A refractive interface found from points, against the one that they were seen through."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from labcal.calibrate.resection.interface import resect_through_interface
from labcal.calibrate.resection.lens_choice import camera_of_lens
from labcal.calibrate.resection.resected import ResectedCamera, resect
from labcal.cameras.camera import Camera
from labcal.cameras.free_parameters import FreeParameters
from labcal.cameras.window import FlatWindow, Wave, WavyWindow

SIZE, SIGMA = (1280, 960), 0.05
K = np.array([[1000.0, 0.0, 640.3], [0.0, 1000.0, 478.2], [0.0, 0.0, 1.0]])
POINTS = np.random.default_rng(2).uniform([-350.0, -300.0, 1400.0], [350.0, 250.0, 2400.0], (140, 3))
PINHOLE = Camera(K, "pinhole", np.zeros(5), np.eye(4), SIZE)


def interface(tilt_deg: float, index: float) -> FlatWindow:
    return FlatWindow(
        kind="interface", distance_mm=200.0, tilt_x_deg=tilt_deg, thickness_mm=0.0, behind_index=index
    )


def through(camera: Camera, seed: int) -> tuple[np.ndarray, ResectedCamera]:
    """Return noisy pixels, and the camera without an interface that is nearest to them."""
    q = camera.project(POINTS).q + SIGMA * np.random.default_rng(seed).standard_normal((140, 2))
    return q, resect("test", q, POINTS, camera_of_lens("pinhole", SIZE, None))


@pytest.mark.parametrize(
    ("tilt_deg", "index"),
    [pytest.param(9.0, 1.1, marks=pytest.mark.slow), (-18.0, 1.2), (30.0, 1.333), (10.0, 1.5)],
)
def test_distance_tilt_and_index_are_found_and_their_covariance_is_right(
    tilt_deg: float, index: float
) -> None:
    true = replace(PINHOLE, window=interface(tilt_deg, index))
    q, without = through(true, 1)
    found = resect_through_interface(q, POINTS, without)
    assert found is not None
    assert found.sigma_px == pytest.approx(SIGMA, rel=0.15)
    free = FreeParameters(found.camera)
    off = free.values - FreeParameters(true).values
    own = found.covariance[-free.count :, -free.count :]
    low, high = chi2(free.count).ppf([0.001, 0.999])
    assert low <= off @ np.linalg.solve(own, off) <= high


def test_thin_glass_before_the_water_changes_nothing() -> None:
    glass = FlatWindow(distance_mm=200.0, tilt_x_deg=30.0, thickness_mm=10.0, behind_index=1.333)
    q, without = through(replace(PINHOLE, window=glass), 3)
    found = resect_through_interface(q, POINTS, without)
    assert found is not None
    assert found.sigma_px == pytest.approx(SIGMA, rel=0.15)
    window = found.camera.window
    assert isinstance(window, FlatWindow)
    assert window.behind_index == pytest.approx(1.333, abs=0.01)


def test_what_is_no_refraction_is_not_taken_for_it() -> None:
    wave = Wave(amplitude_px=(2.0, -1.0), period_px=300.0, direction_deg=20.0)
    for camera in (PINHOLE, replace(PINHOLE, window=WavyWindow(waves=(wave,)))):
        q, without = through(camera, 4)
        assert resect_through_interface(q, POINTS, without) is None


def test_a_known_window_stays_the_only_one() -> None:
    q, without = through(PINHOLE, 5)
    placed = replace(without.placed, camera=replace(without.camera, window=interface(0.0, 1.333)))
    assert resect_through_interface(q, POINTS, replace(without, placed=placed)) is None
