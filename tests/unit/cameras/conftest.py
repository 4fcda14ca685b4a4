"""Cameras of every kind, and where they look."""

import cv2
import numpy as np
import pytest

from labcal.cameras.camera import Camera

DISTORTION = {
    "pinhole": (0.0, 0.0, 0.0, 0.0, 0.0),
    "brown-k1k2": (-0.3, 0.09, 0.0, 0.0, 0.0),
    "brown5": (-0.31, 0.1, -0.0015, 0.0017, -0.01),
    "rational8": (0.9, -0.4, 0.0006, -0.0004, 0.05, 1.25, -0.2, 0.03),
    "thin-prism12": (0.9, -0.4, 0.0006, -0.0004, 0.05, 1.25, -0.2, 0.03, 0.002, -0.001, -0.0015, 0.0008),
    "tilted14": (-0.3, 0.09, 6e-4, -4e-4, 0.01, 0.02, -0.01, 0.003, 2e-3, -1e-3, -1.5e-3, 8e-4, 0.06, -0.09),
    "fisheye-kb4": (-0.04, 0.01, -0.006, 0.001, 0.0),
    "double-sphere": (-0.2, 0.6, 0.0, 0.0, 0.0),
    "eucm": (0.6, 1.1, 0.0, 0.0, 0.0),
    "omni-radtan": (1.2, -0.1, 0.02, 6e-4, -4e-4),
    "telecentric": (-0.31, 0.1, -0.0015, 0.0017, -0.01),
}


def make_camera(
    lens: str, rotation: tuple[float, float, float] = (0.3, -0.2, 0.1), **changes: object
) -> Camera:
    """Return a camera of 640 x 480 that looks along the world's z axis, more or less."""
    T = np.eye(4)
    T[:3, :3] = cv2.Rodrigues(np.array(rotation))[0]
    T[:3, 3] = changes.get("t", (30.0, -50.0, 900.0))
    K = np.array([[700.0, 0.0, 322.4], [0.0, 690.0, 237.1], [0.0, 0.0, 1.0]])
    return Camera(K, lens, np.array(changes.get("dist", DISTORTION[lens])), T, (640, 480))


@pytest.fixture(params=sorted(DISTORTION))
def camera(request: pytest.FixtureRequest) -> Camera:
    """A camera of each lens model."""
    return make_camera(request.param)


@pytest.fixture
def points(camera: Camera) -> np.ndarray:
    """500 points in front of the camera, all in its picture, mm."""
    rng = np.random.default_rng(5)
    depth = rng.uniform(300, 2000, 500)
    x, y = rng.uniform(-0.45, 0.45, 500), rng.uniform(-0.33, 0.33, 500)
    away = np.ones(500) if camera.model.parallel else depth
    local = np.stack([x * away, y * away, depth], axis=-1)
    T = camera.T_cam_world
    return (local - T[:3, 3]) @ T[:3, :3]
