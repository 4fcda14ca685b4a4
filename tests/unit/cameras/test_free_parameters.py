"""Derivatives by a camera's free parameters against differences of its own projection."""

import numpy as np
import pytest

from labcal.cameras.camera import Camera
from labcal.cameras.free_parameters import FreeParameters
from labcal.cameras.prescription import load_prescription
from labcal.cameras.window import WATER, FlatWindow

K = np.array([[700.0, 0.0, 321.0], [0.0, 700.0, 238.0], [0.0, 0.0, 1.0]])
SIZE = (640, 480)
POINTS = np.random.default_rng(3).uniform([-150.0, -120.0, 700.0], [150.0, 120.0, 1500.0], (40, 3))
RATIONAL = np.array([-0.3, 0.1, 1e-3, 2e-3, 0.0, 0.01, 0.02, 0.01])
CAMERAS = {
    "brown5": Camera(K, "brown5", RATIONAL[:5], np.eye(4), SIZE),
    "rational8": Camera(K, "rational8", RATIONAL, np.eye(4), SIZE),
    "fisheye-kb4": Camera(K, "fisheye-kb4", np.array([0.01, 2e-3, 0.0, 0.0, 0.0]), np.eye(4), SIZE),
    "water": Camera(
        K, "brown-k1k2", np.array([-0.2, 0.05, 0.0, 0.0, 0.0]), np.eye(4), SIZE,
        window=FlatWindow(distance_mm=200.0, tilt_x_deg=20.0, tilt_y_deg=-5.0, behind_index=WATER),
    ),
    "interface": Camera(
        K, "brown-k1k2", np.array([-0.2, 0.05, 0.0, 0.0, 0.0]), np.eye(4), SIZE,
        window=FlatWindow(
            kind="interface", distance_mm=200.0, tilt_x_deg=20.0, thickness_mm=0.0, behind_index=1.2
        ),
    ),
    "prescription": Camera(
        K, "prescription", np.zeros(5), np.eye(4), SIZE, load_prescription("webcam-doublet")
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CAMERAS)
def test_derivatives_are_those_of_the_projection(name: str) -> None:
    camera = CAMERAS[name]
    parameters = FreeParameters(camera)
    found = parameters.imaged(POINTS)
    assert found.ok.all()
    np.testing.assert_allclose(found.q, camera.project(POINTS).q, atol=1e-9)
    np.testing.assert_allclose(found.by_point, camera.point_jacobian(POINTS), atol=1e-9)
    for number, value in enumerate(parameters.values):
        step = np.zeros(parameters.count)
        step[number] = 1e-6 * max(1.0, abs(value))
        slope = parameters.moved(step).project(POINTS).q - parameters.moved(-step).project(POINTS).q
        slope /= 2.0 * step[number]
        assert np.abs(found.by_camera[:, :, number] - slope).max() <= 1e-5 * max(1.0, np.abs(slope).max())


@pytest.mark.parametrize(
    ("name", "count"),
    [
        ("brown5", 9),
        ("rational8", 12),
        ("fisheye-kb4", 8),
        ("water", 9),
        ("interface", 10),
        ("prescription", 3),
    ],
)
def test_what_is_free(name: str, count: int) -> None:
    parameters = FreeParameters(CAMERAS[name])
    assert parameters.count == count
    own = parameters.values[parameters.coefficients]
    np.testing.assert_array_equal(own, CAMERAS[name].dist[: len(own)])
