"""Two pinhole cameras about 2 m above the paper's plane and volume, in a few lines of NumPy."""

from collections.abc import Callable

import numpy as np
import pytest

View = Callable[[np.ndarray], np.ndarray]


def _camera(centre: tuple[float, float, float], focal_px: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return K, R, t of a camera that looks at the middle of the scene."""
    position = np.array(centre)
    z = np.array([1000.0, 1000.0, 200.0]) - position
    z /= np.linalg.norm(z)
    x = np.cross(z, [0.0, 1.0, 0.0])
    x /= np.linalg.norm(x)
    R = np.stack([x, np.cross(z, x), z])
    K = np.array([[focal_px, 0.0, 319.5], [0.0, focal_px, 239.5], [0.0, 0.0, 1.0]])
    return K, R, -R @ position


CAMERAS = (_camera((600, 1000, 2100), 900), _camera((1400, 1100, 2000), 950), _camera((1000, 500, 2200), 800))


def _see(points: np.ndarray, count: int) -> np.ndarray:
    columns = []
    for K, R, t in CAMERAS[:count]:
        local = points @ R.T + t
        columns.append((local @ K.T)[:, :2] / local[:, 2:])
    return np.hstack(columns)


@pytest.fixture
def stereo() -> View:
    """Return X, Y, Z in mm as the pixels x1 y1 x2 y2."""
    return lambda points: _see(points, 2)


@pytest.fixture
def three_cameras() -> View:
    """Return X, Y, Z in mm as the pixels of three cameras."""
    return lambda points: _see(points, 3)


@pytest.fixture
def plane() -> np.ndarray:
    """Return 300 points of the paper's plane, mm."""
    x, y = np.meshgrid(np.linspace(650, 1350, 20), np.linspace(650, 1350, 15))
    return np.column_stack((x.ravel(), y.ravel(), np.full(300, 200.0)))


@pytest.fixture
def volume() -> np.ndarray:
    """Return 300 random points of the paper's volume, mm."""
    return np.random.default_rng(11).uniform((650, 650, 0), (1350, 1350, 1000), (300, 3))


@pytest.fixture
def other_plane() -> np.ndarray:
    """Return 1,000 random points of the paper's plane, mm."""
    return np.random.default_rng(12).uniform((650, 650, 200), (1350, 1350, 200), (1000, 3))


@pytest.fixture
def other_volume() -> np.ndarray:
    """Return 1,000 random points of the paper's volume, mm."""
    return np.random.default_rng(13).uniform((650, 650, 0), (1350, 1350, 1000), (1000, 3))
