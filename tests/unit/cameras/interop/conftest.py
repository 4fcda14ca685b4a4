"""Rigs of every lens, in two worlds."""

from collections.abc import Callable

import numpy as np
import pytest

from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.geometry.poses import from_rotation_vector

DISTORTION = {
    "pinhole": (0.0, 0.0, 0.0, 0.0, 0.0),
    "brown-k1k2": (-0.3, 1 / 11, 0.0, 0.0, 0.0),
    "brown5": (-0.31, 0.1, -0.0015, 0.0017, -1e-5),
    "rational8": (0.9, -0.4, 0.0006, -0.0004, 0.05, 1.25, -0.2, 1 / 30),
    "thin-prism12": (0.9, -0.4, 0.0006, -0.0004, 0.05, 1.25, -0.2, 0.03, 0.002, -0.001, -0.0015, 8e-5),
    "tilted14": (-0.3, 0.09, 6e-4, -4e-4, 0.01, 0.02, -0.01, 0.003, 2e-3, -1e-3, -1.5e-3, 8e-4, 0.06, -0.09),
    "fisheye-kb4": (-0.04, 0.01, -0.006, 0.001, 0.0),
    "double-sphere": (-0.2, 1 / 1.7, 0.0, 0.0, 0.0),
    "eucm": (1 / 1.7, 1.1, 0.0, 0.0, 0.0),
    "omni-radtan": (1.2, -1 / 11, 0.02, 6e-4, -4e-5),
    "telecentric": (-0.31, 0.1, -0.0015, 0.0017, -0.01),
}
SECOND_FROM_FIRST = from_rotation_vector(np.array([0.02, 0.25, -0.03]), np.array([-180.3, 6.1, 25.7]))
ELSEWHERE = from_rotation_vector(np.array([0.5, 0.2, -0.3]), np.array([10.3, 600.1, 1 / 3]))


MakeRig = Callable[..., Rig]


def _rig(lens: str, T_first_world: np.ndarray | None = None, count: int = 2) -> Rig:
    """Return cameras with one lens; from the second on they stand one step further each."""
    K = np.array([[700.1, 0.0, 322.4], [0.0, 690.2, 237.1], [0.0, 0.0, 1.0]])
    cameras, T = {}, np.eye(4) if T_first_world is None else T_first_world
    for name in ("left", "right-2", "third")[:count]:
        cameras[name] = Camera(K, lens, np.array(DISTORTION[lens]), T, (640, 480))
        K, T = K - np.diag([9.1, 8.3, 0.0]), SECOND_FROM_FIRST @ T
    return Rig.of(cameras)


@pytest.fixture
def make_rig() -> MakeRig:
    """Return what makes a rig."""
    return _rig


@pytest.fixture
def elsewhere() -> np.ndarray:
    """``T_first_world`` of a rig whose world is not its first camera."""
    return ELSEWHERE


@pytest.fixture
def points() -> np.ndarray:
    """200 points in front of the first camera of a rig whose world it is, mm."""
    rng = np.random.default_rng(7)
    depth = rng.uniform(600.0, 2000.0, 200)
    across = rng.uniform([-0.2, -0.25], [0.45, 0.25], (200, 2))
    return np.column_stack([across * depth[:, None], depth])
