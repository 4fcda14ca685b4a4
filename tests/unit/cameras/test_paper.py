"""The paper's camera against its equations multiplied out by hand, and against the OpenCV camera."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from labcal.cameras.camera import Camera
from labcal.cameras.paper import PaperCamera, paper_camera
from labcal.errors import InputError

PITCH_MM = 0.005
MIDDLE = (322.4, 237.1)


def random_camera(rng: np.random.Generator, r: float = 1.0) -> PaperCamera:
    """Return a camera above the scene that looks down."""
    return PaperCamera(
        focal_length_mm=float(rng.uniform(4, 20)),
        gimbal_mm=rng.uniform([0, 0, 2000], [2000, 2000, 3000]),
        pan_rad=float(rng.uniform(-np.pi, np.pi)),
        tilt_rad=float(rng.uniform(2.3, np.pi)),
        displacement_mm=r * rng.normal(size=3) * 20,
    )


def by_hand(camera: PaperCamera, X: float, Y: float, Z: float) -> tuple[float, float]:
    """Return x and y of Eq. 10 and 11, the product P C R G written out."""
    X0, Y0, Z0 = camera.gimbal_mm
    r1, r2, r3 = camera.displacement_mm
    ct, st = np.cos(camera.pan_rad), np.sin(camera.pan_rad)
    ca, sa = np.cos(camera.tilt_rad), np.sin(camera.tilt_rad)
    lam = camera.focal_length_mm
    depth = (X - X0) * st * sa - (Y - Y0) * ct * sa + (Z - Z0) * ca - r3
    x = lam * ((X - X0) * ct + (Y - Y0) * st - r1) / (lam - depth)
    y = lam * (-(X - X0) * st * ca + (Y - Y0) * ct * ca + (Z - Z0) * sa - r2) / (lam - depth)
    return x, y


def test_projects_by_the_equations() -> None:
    rng = np.random.default_rng(1)
    for _ in range(50):
        camera = random_camera(rng)
        p = rng.uniform(0, [2000, 2000, 1000], (20, 3))
        image, ok = camera.project(p)
        assert ok.any()
        expected = np.array([by_hand(camera, *point) for point in p])
        np.testing.assert_allclose(image[ok], expected[ok], rtol=1e-11, atol=1e-11)


def test_the_corrected_row_of_g_stands_in_the_matrix() -> None:
    camera = PaperCamera(10.0, np.array([100.0, 200.0, 300.0]), 0.0, 0.0, np.zeros(3))
    # Without pan and tilt: G moves, P divides by 1 - z / lambda. The misprinted row would add Z there.
    expected = [[1, 0, 0, -100], [0, 1, 0, -200], [0, 0, 1, -300], [0, 0, -0.1, 31]]
    np.testing.assert_allclose(camera.matrix, expected, atol=1e-12)


def test_the_opencv_camera_is_the_same_camera() -> None:
    rng = np.random.default_rng(2)
    for _ in range(50):
        paper = random_camera(rng)
        camera = paper.camera(PITCH_MM, MIDDLE, (640, 480))
        p = rng.uniform(0, [2000, 2000, 1000], (20, 3))
        image, ok = paper.project(p)
        # OpenCV's frame is turned by 180 degrees, so that the inverted image is upright in its pixels.
        expected = np.array(MIDDLE) + image / PITCH_MM
        found = camera.project(p)
        np.testing.assert_array_equal(found.ok, ok)
        np.testing.assert_allclose(found.q[ok], expected[ok], rtol=0, atol=1e-7)
        rotation, _ = cv2.Rodrigues(camera.T_cam_world[:3, :3])
        q, _ = cv2.projectPoints(p[ok], rotation, camera.T_cam_world[:3, 3], camera.K, None)
        np.testing.assert_allclose(q[:, 0], expected[ok], rtol=0, atol=1e-7)


def test_there_and_back_is_the_same_camera() -> None:
    rng = np.random.default_rng(3)
    for _ in range(50):
        paper = random_camera(rng, r=0.0)
        back = paper_camera(paper.camera(PITCH_MM, MIDDLE, (640, 480)), PITCH_MM)
        assert back.focal_length_mm == pytest.approx(paper.focal_length_mm)
        np.testing.assert_allclose(back.gimbal_mm, paper.gimbal_mm, atol=1e-8)
        np.testing.assert_allclose(back.matrix, paper.matrix, atol=1e-8)
        np.testing.assert_array_equal(back.displacement_mm, 0)


def test_a_displaced_camera_comes_back_as_one_without_that_sees_the_same() -> None:
    rng = np.random.default_rng(4)
    paper = random_camera(rng)
    back = paper_camera(paper.camera(PITCH_MM, MIDDLE, (640, 480)), PITCH_MM)
    p = rng.uniform(0, [2000, 2000, 1000], (50, 3))
    np.testing.assert_allclose(back.project(p)[0], paper.project(p)[0], atol=1e-9)


def test_what_lies_behind_the_lens_is_not_imaged() -> None:
    camera = PaperCamera(10.0, np.zeros(3), 0.0, 0.0, np.zeros(3))  # the lens is at z = 10, looks along z
    image, ok = camera.project(np.array([[1.0, 0, 20], [1.0, 0, 10], [1.0, 0, 5], [1.0, 0, -100]]))
    np.testing.assert_array_equal(ok, [True, False, False, False])
    np.testing.assert_allclose(image[0], [-1.0, 0.0])  # inverted
    assert np.isnan(image[1:]).all()


def test_cameras_that_the_paper_cannot_hold_are_refused_by_name() -> None:
    paper = random_camera(np.random.default_rng(5))
    camera = paper.camera(PITCH_MM, MIDDLE, (640, 480))
    barrel = replace(camera, lens="brown5", dist=np.array([-0.1, 0, 0, 0, 0.0]))
    with pytest.raises(InputError, match=r"no lens distortion, but this one is 'brown5'"):
        paper_camera(barrel, PITCH_MM)
    with pytest.raises(InputError, match="fx = "):
        paper_camera(replace(camera, K=camera.K * [[1.01, 1, 1], [1, 1, 1], [1, 1, 1]]), PITCH_MM)
    roll = np.eye(4)
    roll[:3, :3] = cv2.Rodrigues(np.radians([0, 0, 5.0]))[0]
    with pytest.raises(InputError, match=r"roll.*by -?\d"):
        paper_camera(replace(camera, T_cam_world=roll @ camera.T_cam_world), PITCH_MM)
    with pytest.raises(InputError, match="must be positive"):
        replace(paper, focal_length_mm=0.0)


def test_the_camera_class_is_opencvs() -> None:
    camera = random_camera(np.random.default_rng(6)).camera(PITCH_MM, MIDDLE, (640, 480))
    assert isinstance(camera, Camera)
    assert camera.lens == "pinhole"
    assert (camera.K[0, 2], camera.K[1, 2]) == MIDDLE
    assert np.linalg.det(camera.T_cam_world[:3, :3]) == pytest.approx(1)
