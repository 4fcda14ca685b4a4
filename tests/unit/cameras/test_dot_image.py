"""The image of a dot against the conic of a projected circle, and against an area that is counted."""

import cv2
import numpy as np
import pytest

from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import SAMPLES, dot_images

K = np.array([[700.0, 0.0, 322.4], [0.0, 690.0, 237.1], [0.0, 0.0, 1.0]])
CENTRES = np.array([[0.0, 0, 0], [60, 0, 0], [-50, 40, 0], [30, -45, 0]])
RADII = np.array([5.0, 12.0, 20.0, 8.0])


def tilted(degrees: float) -> np.ndarray:
    """Return a target that is turned and tilted, 400 mm in front of a camera that sees its front."""
    T = np.eye(4)
    turn, _ = cv2.Rodrigues(np.radians([degrees, 0.3 * degrees, 20.0]))
    T[:3, :3] = np.diag([1.0, -1.0, -1.0]) @ turn
    T[:3, 3] = [20.0, -10.0, 400.0]
    return T


def conic_centre(T: np.ndarray, centre: np.ndarray, radius: float) -> np.ndarray:
    """Return the centre of the ellipse that a pinhole makes of a circle, from the conic's matrix."""
    middle = T[:3, :3] @ centre + T[:3, 3]
    q0 = (K @ middle)[:2] / middle[2]
    to_middle = np.array([[1, 0, -q0[0]], [0, 1, -q0[1]], [0, 0, 1.0]])  # where no digits are lost
    H = to_middle @ K @ np.column_stack([T[:3, 0], T[:3, 1], middle])
    inverse = np.linalg.inv(H)
    conic = inverse.T @ np.diag([1.0, 1.0, -(radius**2)]) @ inverse
    return q0 - np.linalg.solve(conic[:2, :2], conic[:2, 2])


@pytest.mark.parametrize("degrees", [0.0, 25.0, 60.0])
def test_a_pinhole_images_a_circle_as_its_conic(degrees: float) -> None:
    camera = Camera(K, "pinhole", np.zeros(5), np.eye(4), (640, 480))
    T = tilted(degrees)
    found = dot_images(camera, T, CENTRES, RADII)
    expected = [conic_centre(T, centre, radius) for centre, radius in zip(CENTRES, RADII, strict=True)]
    assert found.ok.all()
    np.testing.assert_allclose(found.centroid, expected, rtol=0, atol=1e-9)
    shift = np.linalg.norm(found.centroid - found.centre, axis=1)
    assert shift.max() < 1e-9 if degrees == 0 else shift.min() > 1e-3


def counted_centroid(camera: Camera, T: np.ndarray, centre: np.ndarray, radius: float) -> np.ndarray:
    """Return the mean of the positions, on a grid of 1/10 px, whose rays meet the dot."""
    middle = camera.project(T[:3, :3] @ centre + T[:3, 3]).q
    offset = np.arange(-2.3 * radius, 2.3 * radius, 0.1)
    q = np.stack(np.meshgrid(middle[0] + offset, middle[1] + offset), axis=-1).reshape(-1, 2)
    rays = camera.rays(q)
    normal = T[:3, 2]
    along = ((T[:3, 3] - rays.origin) @ normal) / (rays.direction @ normal)
    local = (rays.origin + along[:, None] * rays.direction - T[:3, 3]) @ T[:3, :3] - centre
    return q[np.hypot(local[:, 0], local[:, 1]) < radius].mean(axis=0)


@pytest.mark.parametrize("number", range(len(CENTRES)))
def test_a_distorted_dot_has_the_centroid_of_its_counted_area(number: int) -> None:
    camera = Camera(K, "brown5", np.array([-0.35, 0.12, 0.003, -0.002, 0.0]), np.eye(4), (640, 480))
    T = tilted(35.0)
    T[0, 3] = 60.0  # towards the edge, where the distortion bends the outline
    found = dot_images(camera, T, CENTRES, RADII)
    expected = counted_centroid(camera, T, CENTRES[number], RADII[number])
    np.testing.assert_allclose(found.centroid[number], expected, rtol=0, atol=5e-3)
    if RADII[number] > 10:
        assert np.linalg.norm(found.centroid[number] - found.centre[number]) > 0.1


def test_the_outline_runs_from_x_to_y() -> None:
    camera = Camera(K, "brown5", np.array([-0.3, 0.1, 0.0, 0.0, 0.0]), np.eye(4), (640, 480))
    T = tilted(30.0)
    found = dot_images(camera, T, CENTRES, RADII)
    assert found.outline.shape == (4, SAMPLES, 2)
    for sample, step in ((0, [1.0, 0, 0]), (SAMPLES // 4, [0, 1.0, 0])):
        edge = (CENTRES + RADII[:, None] * step) @ T[:3, :3].T + T[:3, 3]
        np.testing.assert_allclose(found.outline[:, sample], camera.project(edge).q, atol=1e-9)
    np.testing.assert_allclose(found.centre, camera.project(CENTRES @ T[:3, :3].T + T[:3, 3]).q, atol=1e-12)


def test_a_dot_that_is_imaged_in_part_is_none() -> None:
    camera = Camera(K, "pinhole", np.zeros(5), np.eye(4), (640, 480))
    T = np.eye(4)
    T[:3, :3] = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])  # the target's x points at the camera
    T[:3, 3] = [0.0, 0.0, 100.0]
    found = dot_images(camera, T, np.array([[0.0, 0, 0], [95.0, 0, 0], [200.0, 0, 0]]), np.full(3, 10.0))
    np.testing.assert_array_equal(found.ok, [True, False, False])
    assert np.isnan(found.centroid[1:]).all()
    assert np.isnan(found.outline[1:]).all()
    assert np.isfinite(found.centre[1]).all()  # its middle is still in front


def test_a_place_without_extent_is_its_own_centroid() -> None:
    camera = Camera(K, "brown5", np.array([-0.3, 0.1, 1e-3, -1e-3, 0.0]), np.eye(4), (640, 480))
    found = dot_images(camera, tilted(40.0), CENTRES, RADII * [1.0, 0.0, 1.0, 0.0])
    assert np.array_equal(found.centroid[[1, 3]], found.centre[[1, 3]])
    assert (found.centroid[[0, 2]] != found.centre[[0, 2]]).any(axis=1).all()
