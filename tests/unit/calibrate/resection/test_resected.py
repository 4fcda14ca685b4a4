"""A camera from points in space, against the camera that saw them."""

from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest
from scipy.stats import chi2

from labcal.calibrate.lens_prior import PriorWidth
from labcal.calibrate.resection import lens_choice
from labcal.calibrate.resection.lens_choice import camera_of_lens, chosen_camera
from labcal.calibrate.resection.placed import PlacedCamera
from labcal.calibrate.resection.resected import ResectedCamera, adjusted_with_prior, resect
from labcal.cameras.camera import Camera
from labcal.cameras.free_parameters import FreeParameters
from labcal.cameras.window import WATER, FlatWindow
from labcal.errors import InputError, UnknownNameError
from labcal.estimators.gp_field.fitted_camera import FittedCamera

SIZE = (640, 480)
K = np.array([[600.0, 0.0, 322.0], [0.0, 603.0, 237.0], [0.0, 0.0, 1.0]])
T = np.array(
    [[0.96, 0.0, 0.28, -40.0], [0.0, 1.0, 0.0, 12.0], [-0.28, 0.0, 0.96, 30.0], [0.0, 0.0, 0.0, 1.0]]
)
POINTS = np.random.default_rng(2).uniform([-120.0, -90.0, 250.0], [120.0, 90.0, 420.0], (200, 3))
TRUE = {
    "pinhole": Camera(K, "pinhole", np.zeros(5), T, SIZE),
    "brown5": Camera(K, "brown5", np.array([-0.28, 0.1, 1e-3, -1e-3, 0.0]), T, SIZE),
    "fisheye-kb4": Camera(K, "fisheye-kb4", np.array([0.03, -0.01, 0.0, 0.0, 0.0]), T, SIZE),
}


@pytest.mark.parametrize("lens", TRUE)
def test_exact_pixels_give_the_camera(lens: str) -> None:
    true = TRUE[lens]
    found = resect("test", true.project(POINTS).q, POINTS, camera_of_lens(lens, SIZE, None)).camera
    np.testing.assert_allclose(found.K, true.K, atol=1e-4)
    np.testing.assert_allclose(found.dist[: len(true.dist)], true.dist, atol=1e-6)
    np.testing.assert_allclose(found.T_cam_world, true.T_cam_world, atol=1e-4)


def test_opencv_finds_no_less_cost() -> None:
    q = TRUE["brown5"].project(POINTS).q + 0.1 * np.random.default_rng(5).standard_normal((200, 2))
    found = resect("test", q, POINTS, camera_of_lens("brown5", SIZE, None))
    rms, *_ = cv2.calibrateCamera(
        [POINTS.astype(np.float32)], [q.astype(np.float32)], SIZE, K.copy(), np.zeros(5),
        flags=cv2.CALIB_USE_INTRINSIC_GUESS, criteria=(3, 200, 1e-12),
    )  # fmt: skip
    own = np.sqrt((found.residual**2).sum(axis=1).mean())
    assert own == pytest.approx(rms, rel=1e-5)


def test_parts_of_the_dots_are_held_as_tight_as_the_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    """Dots in the middle leave the border of the picture open: some lenses are held by the narrow prior."""
    near = POINTS * (0.3, 0.3, 1.0) + (0.0, 0.0, 60.0)
    q = TRUE["brown5"].project(near).q + 0.05 * np.random.default_rng(6).standard_normal((200, 2))
    whole: dict[str, PriorWidth] = {}
    parts: set[tuple[str, PriorWidth]] = set()

    def resected(method: str, q: np.ndarray, p: np.ndarray, kind: Camera) -> ResectedCamera:
        found = resect(method, q, p, kind)
        whole[kind.lens] = found.held
        return found

    def adjusted(start: PlacedCamera, *rest: Any) -> ResectedCamera:  # noqa: ANN401 - passed on as they are
        parts.add((start.camera.lens, rest[-1]))
        return adjusted_with_prior(start, *rest)

    monkeypatch.setattr(lens_choice, "resect", resected)
    monkeypatch.setattr(lens_choice, "adjusted_with_prior", adjusted)
    chosen_camera("test", q, near, SIZE)
    assert set(whole.values()) == set(PriorWidth)  # else this would test nothing
    assert parts == set(whole.items())


def test_a_prescription_and_a_window_under_water_are_found() -> None:
    glass = camera_of_lens("webcam-doublet", SIZE, None)
    true = replace(
        glass, K=np.array([[650.0, 0.0, 318.0], [0.0, 650.0, 242.0], [0.0, 0.0, 1.0]]), T_cam_world=T
    )
    found = resect("test", true.project(POINTS).q, POINTS, glass).camera
    np.testing.assert_allclose(found.K, true.K, atol=1e-4)
    window = FlatWindow(distance_mm=60.0, tilt_x_deg=15.0, tilt_y_deg=-4.0, behind_index=WATER)
    true = Camera(K, "pinhole", np.zeros(5), T, SIZE, window=window)
    start = FlatWindow(distance_mm=100.0, behind_index=WATER)
    found = resect("test", true.project(POINTS).q, POINTS, camera_of_lens("pinhole", SIZE, start)).camera
    np.testing.assert_allclose(
        FreeParameters(found).values, FreeParameters(true).values, rtol=1e-4, atol=1e-5
    )


def test_stated_covariances_are_those_of_repeated_resections() -> None:
    true, random = TRUE["brown5"], np.random.default_rng(7)
    q, sigma = true.project(POINTS).q, 0.2
    asked = np.array([[20.0, -30.0, 330.0], [-110.0, 80.0, 400.0]])
    truth, statistic, runs, nothing = true.project(asked).q, 0.0, 12, np.zeros((2, 2, 2))
    for _ in range(runs):
        found = resect(
            "test", q + sigma * random.standard_normal(q.shape), POINTS, camera_of_lens("brown5", SIZE, None)
        )
        assert found.sigma_px == pytest.approx(sigma, rel=0.15)
        error = found.camera.project(asked).q - truth
        learned = FittedCamera(found.placed, found.covariance, found.sigma_px)
        stated = learned.pixel_covariance(truth, asked, nothing)
        statistic += np.einsum("ni,nij,nj->", error, np.linalg.inv(stated), error)
    assert 0.001 < chi2(4 * runs).cdf(statistic) < 0.999


@pytest.mark.parametrize("lens", TRUE)
def test_held_out_dots_choose_the_lens(lens: str) -> None:
    q = TRUE[lens].project(POINTS).q + 0.05 * np.random.default_rng(1).standard_normal((200, 2))
    assert chosen_camera("test", q, POINTS, SIZE).camera.lens == lens


def test_what_determines_no_camera_is_refused() -> None:
    random, kind = np.random.default_rng(3), camera_of_lens("pinhole", SIZE, None)
    q = TRUE["pinhole"].project(POINTS).q
    with pytest.raises(InputError, match="at least 6"):
        resect("test", q[:5], POINTS[:5], kind)
    flat = POINTS * [1.0, 1.0, 0.0] + np.array([0.0, 0.0, 300.0])
    with pytest.raises(InputError, match="one plane"):
        resect("test", TRUE["pinhole"].project(flat).q, flat, kind)
    line = np.outer(np.arange(50.0), [1.0, 2.0, 0.5]) + np.array([0.0, 0.0, 300.0])
    with pytest.raises(InputError, match="one line"):
        resect("test", TRUE["pinhole"].project(line).q, line, kind)
    with pytest.raises(InputError, match="belong together"):
        resect("test", random.uniform(0, 480, (200, 2)), POINTS, kind)
    with pytest.raises(UnknownNameError, match="brown5"):
        camera_of_lens("brown-5", SIZE, None)
