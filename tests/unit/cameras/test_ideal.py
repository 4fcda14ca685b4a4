"""Ideal pinholes: where they are, what they see, and which pixels they take."""

import cv2
import numpy as np
import pytest

from labcal.cameras.camera import Camera
from labcal.cameras.ideal import ideal_camera, rectified_pair, whole_ideal_camera
from labcal.cameras.remapping import source_pixels
from labcal.cameras.window import FlatWindow
from labcal.errors import InputError
from labcal.geometry.poses import from_rotation_vector

BROWN = np.array([-0.3, 0.1, 1e-3, -2e-3, -0.01])
FISHEYE = np.array([-0.04, 0.01, -0.006, 0.001, 0.0])
WORLD = from_rotation_vector(np.array([0.4, -0.2, 0.9]), np.array([50.0, -30.0, 700.0]))


def a_pair(lens: str = "brown5", dist: np.ndarray = BROWN, turn: float = 0.3) -> tuple[Camera, Camera]:
    """Return two cameras that look at the same place from either side."""
    K = np.array([[500.0, 0.0, 322.4], [0.0, 494.0, 237.1], [0.0, 0.0, 1.0]])
    step = from_rotation_vector(np.array([0.03, turn, -0.05]), np.array([-200.0, 12.0, 30.0]))
    right = K + np.diag([20.0, 19.0, 0.0])
    return Camera(K, lens, dist, WORLD, (640, 480)), Camera(right, lens, dist, step @ WORLD, (640, 480))


@pytest.mark.parametrize(("lens", "dist"), [("brown5", BROWN), ("fisheye-kb4", FISHEYE)])
@pytest.mark.parametrize("swapped", [False, True])
def test_a_point_has_one_row_in_a_rectified_pair(lens: str, dist: np.ndarray, *, swapped: bool) -> None:
    pair = a_pair(lens, dist)
    first, second = pair[::-1] if swapped else pair
    left, right = rectified_pair(first, second)
    rng = np.random.default_rng(5)
    depth = rng.uniform(600.0, 2000.0, (300, 1))
    rays = first.rays(rng.uniform([100.0, 60.0], [540.0, 420.0], (300, 2)))
    p = rays.origin + depth * rays.direction
    a, b = left.project(p), right.project(p)
    both = a.ok & b.ok
    assert both.sum() > 200
    np.testing.assert_allclose(a.q[both, 1], b.q[both, 1], atol=1e-9)
    np.testing.assert_array_equal(left.T_cam_world[:3, :3], right.T_cam_world[:3, :3])
    for ideal, camera in ((left, first), (right, second)):
        np.testing.assert_allclose(ideal.centre, camera.centre, atol=1e-10)
        assert ideal.T_cam_world[0, :3] @ camera.T_cam_world[0, :3] > 0.9  # the picture stays upright
        corners = camera.rays(np.array([[0.0, 0.0], [639.0, 0.0], [0.0, 479.0], [639.0, 479.0]]))
        assert ideal.in_picture(ideal.project(corners.origin + 500.0 * corners.direction).q).all()
    assert left.size == right.size
    assert (left.K[1] == right.K[1]).all()
    assert left.K[0, 0] == pytest.approx((500.0 * 494.0 * 520.0 * 513.0) ** 0.25)


def test_the_map_is_opencvs() -> None:
    camera, _ = a_pair()
    ideal = ideal_camera(camera)
    x, y = cv2.initUndistortRectifyMap(camera.K, camera.dist, np.eye(3), ideal.K, camera.size, cv2.CV_32FC1)
    found = source_pixels(camera, ideal)
    assert np.isfinite(found).all()
    np.testing.assert_allclose(found, np.dstack([x, y]), atol=2e-3)  # OpenCV's is rounded on its way


def test_the_map_of_a_fisheye_is_opencvs() -> None:
    camera, _ = a_pair("fisheye-kb4", FISHEYE)
    ideal = whole_ideal_camera(camera)
    x, y = cv2.fisheye.initUndistortRectifyMap(
        camera.K, camera.dist[:4], np.eye(3), ideal.K, ideal.size, cv2.CV_32FC1
    )
    found = source_pixels(camera, ideal)
    assert ideal.size[0] > 1.3 * camera.size[0]
    ok = np.isfinite(found).all(axis=2)
    assert ok.mean() > 0.99
    np.testing.assert_allclose(found[ok], np.dstack([x, y])[ok], atol=2e-3)


def test_what_is_beyond_sixty_degrees_is_cut() -> None:
    K = np.array([[200.0, 0.0, 319.5], [0.0, 200.0, 239.5], [0.0, 0.0, 1.0]])  # 180 degrees across
    ideal = whole_ideal_camera(Camera(K, "fisheye-kb4", FISHEYE, WORLD, (640, 480)))
    assert ideal.size[0] / 2.0 / ideal.K[0, 0] == pytest.approx(np.tan(np.radians(60.0)), rel=0.02)


def test_cameras_that_cannot_be_rectified() -> None:
    first, _ = a_pair()
    with pytest.raises(InputError, match="at one place"):
        rectified_pair(first, first)
    ahead = from_rotation_vector(np.zeros(3), np.array([5.0, 0.0, -300.0])) @ WORLD
    with pytest.raises(InputError, match="ahead of the other"):
        rectified_pair(first, Camera(first.K, first.lens, first.dist, ahead, first.size))


def test_rays_that_do_not_meet_need_a_distance() -> None:
    first, _ = a_pair()
    window = FlatWindow(kind="flat", distance_mm=50.0, thickness_mm=10.0, glass_index=1.5, behind_index=1.333)
    camera = Camera(first.K, first.lens, first.dist, WORLD, first.size, window=window)
    ideal = ideal_camera(camera)
    with pytest.raises(InputError, match="`distance_mm`"):
        source_pixels(camera, ideal)
    found = source_pixels(camera, ideal, 800.0)
    pixel = np.array([400.0, 300.0])
    ray = ideal.rays(pixel)
    expected = camera.project(ray.origin + 800.0 * ray.direction).q
    np.testing.assert_allclose(found[300, 400], expected, atol=1e-4)
    assert abs(found[300, 400] - source_pixels(first, ideal)[300, 400]).max() > 5.0
