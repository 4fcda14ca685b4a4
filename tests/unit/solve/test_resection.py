"""A camera from points in space, against the camera that saw them."""

import numpy as np
import pytest

from labcal.cameras.camera import Camera
from labcal.errors import InputError
from labcal.solve.resection import resected_camera


@pytest.fixture
def true(pair: dict[str, Camera]) -> Camera:
    camera = pair["right"]
    return Camera(camera.K, "brown-k1k2", np.array([-0.28, 0.1, 0, 0, 0]), camera.T_cam_world, camera.size)


def test_the_camera_is_found(true: Camera) -> None:
    p = np.random.default_rng(2).uniform([-80, -60, 280], [160, 60, 400], (120, 3))
    found = resected_camera(true.project(p).q, p, true.size)
    np.testing.assert_allclose(found.K, true.K, atol=1e-3)
    np.testing.assert_allclose(found.dist, true.dist, atol=1e-4)
    np.testing.assert_allclose(found.T_cam_world, true.T_cam_world, atol=1e-2)


def test_what_determines_no_camera_is_refused(true: Camera) -> None:
    random = np.random.default_rng(3)
    p = random.uniform([-80, -60, 300], [160, 60, 300], (60, 3))
    with pytest.raises(InputError, match="on one plane"):
        resected_camera(true.project(p).q, p, true.size)
    p = random.uniform([-80, -60, 280], [160, 60, 400], (60, 3))
    with pytest.raises(InputError, match="at least 12"):
        resected_camera(true.project(p[:9]).q, p[:9], true.size)
    with pytest.raises(InputError, match="resection"):
        resected_camera(random.uniform(0, 480, (60, 2)), p, true.size)
