"""Points from two and three cameras against OpenCV and against their own statistics."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from scipy.stats import chi2

from labcal.cameras.camera import Camera
from labcal.cameras.triangulation import epipolar_distances, triangulate, triangulation_limit

SIZE = (640, 480)


def looking(x: float, turn: float, lens: str = "brown5", focal: float = 700.0) -> Camera:
    """Return a camera on the world's x axis that looks along z, turned inwards."""
    K = np.array([[focal, 0.0, 322.4], [0.0, focal, 237.1], [0.0, 0.0, 1.0]])
    T = np.eye(4)
    T[:3, :3] = cv2.Rodrigues(np.array([0.02, -turn, 0.01]))[0]
    T[:3, 3] = -T[:3, :3] @ [x, 10.0, 0.0]
    dist = np.array([-0.3, 0.09, 0.001, -0.001, 0.0]) if lens == "brown5" else np.zeros(5)
    return Camera(K, lens, dist, T, SIZE)


BARRELS = (looking(-200, 0.15), looking(200, -0.2, focal=650.0))
PINHOLES = (looking(-200, 0.15, "pinhole"), looking(200, -0.2, "pinhole"))
PARALLEL = tuple(
    replace(
        camera,
        K=np.array([[0.8, 0.0, 322.4], [0.0, 0.81, 237.1], [0.0, 0.0, 1.0]]),
        lens="telecentric",
        dist=np.array([-2e-7, 1e-13, 4e-7, -6e-7, 0.0]),
    )
    for camera in PINHOLES
)
THREE = (*BARRELS, looking(0, 0.0, "pinhole", 900.0))


def scene(count: int = 200) -> np.ndarray:
    return np.random.default_rng(1).uniform([-200, -150, 1200], [200, 150, 1800], (count, 3))


def seen(cameras: tuple[Camera, ...], p: np.ndarray) -> np.ndarray:
    return np.stack([camera.project(p).q for camera in cameras], axis=1)


def unit_covariances(q: np.ndarray) -> np.ndarray:
    return np.tile(np.eye(2), (*q.shape[:2], 1, 1))


@pytest.mark.parametrize(
    "cameras", [BARRELS, PINHOLES, PARALLEL, THREE], ids=["barrels", "pinholes", "parallel", "three"]
)
def test_exact_pixels_give_the_points(cameras: tuple[Camera, ...]) -> None:
    p = scene()
    q = seen(cameras, p)
    found = triangulate(cameras, q, unit_covariances(q))
    assert found.ok.all()
    np.testing.assert_allclose(found.point, p, rtol=0, atol=1e-7)


def test_opencv_finds_the_same_points() -> None:
    q = seen(PINHOLES, scene())
    matrices = [camera.K @ camera.T_cam_world[:3] for camera in PINHOLES]
    homogeneous = cv2.triangulatePoints(*matrices, q[:, 0].T, q[:, 1].T)
    found = triangulate(PINHOLES, q, unit_covariances(q))
    np.testing.assert_allclose(found.point, (homogeneous[:3] / homogeneous[3]).T, rtol=0, atol=1e-6)


def random_covariances(rng: np.random.Generator, shape: tuple[int, ...]) -> np.ndarray:
    root = 0.2 * rng.normal(size=(*shape, 2, 2)) + 0.3 * np.eye(2)
    return root @ np.swapaxes(root, -1, -2)


@pytest.mark.parametrize("cameras", [BARRELS, PARALLEL, THREE], ids=["two", "parallel", "three"])
def test_the_covariance_is_that_of_repeated_measurements(cameras: tuple[Camera, ...]) -> None:
    rng = np.random.default_rng(2)
    p = np.tile([[60.0, -40.0, 1500.0]], (4000, 1))
    covariance = np.tile(random_covariances(rng, (1, len(cameras))), (4000, 1, 1, 1))
    noise = np.linalg.cholesky(covariance) @ rng.normal(size=(4000, len(cameras), 2, 1))
    found = triangulate(cameras, seen(cameras, p) + noise[..., 0], covariance)
    error = found.point - p
    distance = np.einsum("ni,ni->n", error, np.linalg.solve(found.covariance, error[..., None])[..., 0])
    # The sum of squared distances is chi-square with 3 degrees of freedom each, 12000 in all.
    assert chi2.ppf(1e-4, 12000) < distance.sum() < chi2.ppf(1 - 1e-4, 12000)
    # Direction by direction: whitened errors have a variance of 1, in every direction.
    white = np.linalg.solve(np.linalg.cholesky(found.covariance), error[..., None])[..., 0]
    low, high = chi2.ppf(1e-5, 4000) / 4000, chi2.ppf(1 - 1e-5, 4000) / 4000
    assert all(low < variance < high for variance in np.linalg.eigvalsh(white.T @ white / 4000))


def test_the_limit_is_the_covariance_at_the_true_point() -> None:
    p = scene(20)
    q = seen(BARRELS, p)
    covariance = random_covariances(np.random.default_rng(3), q.shape[:2])
    limit = triangulation_limit(BARRELS, p, covariance)
    np.testing.assert_allclose(limit, triangulate(BARRELS, q, covariance).covariance, rtol=1e-6)
    # The definition: the inverse of J' W J, with slopes by differences.
    J = np.stack(
        [(seen(BARRELS, p + 1e-3 * axis) - seen(BARRELS, p - 1e-3 * axis)) / 2e-3 for axis in np.eye(3)],
        axis=-1,
    )
    normal = np.einsum("ncki,nckl,nclj->nij", J, np.linalg.inv(covariance), J)
    np.testing.assert_allclose(limit, np.linalg.inv(normal), rtol=1e-5)


def test_uncertain_pixels_count_less() -> None:
    p = scene(1)
    q = seen(THREE, p)
    q[0, 0] += [40.0, 25.0]
    covariance = unit_covariances(q)
    covariance[0, 0] *= 1e8
    found = triangulate(THREE, q, covariance)
    np.testing.assert_allclose(found.point, p, atol=1e-2)
    assert np.linalg.norm(triangulate(THREE, q, unit_covariances(q)).point - p) > 1.0


def test_pixels_that_determine_no_point_are_flagged() -> None:
    p = scene(6)
    q = seen(PINHOLES, p)
    covariance = unit_covariances(q)
    q[1, 0] = np.nan
    covariance[2, 1] = np.nan
    covariance[3, 1] = 0.0
    horizon = np.array([[0.0, 0.0, 1e13]])
    q[4] = seen(PINHOLES, horizon)[0]
    q[5] = [[10.0, 240.0], [630.0, 240.0]]  # rays that part: they are nearest behind the cameras
    found = triangulate(PINHOLES, q, covariance)
    np.testing.assert_array_equal(found.ok[:4], [True, False, False, False])
    assert not found.ok[5]
    assert np.isnan(found.point[~found.ok]).all()
    assert np.isnan(found.covariance[~found.ok]).all()
    assert np.isfinite(found.point[found.ok]).all()


def test_nothing_gives_nothing() -> None:
    found = triangulate(BARRELS, np.zeros((0, 2, 2)), np.zeros((0, 2, 2, 2)))
    assert found.point.shape == (0, 3)
    assert found.covariance.shape == (0, 3, 3)


def fundamental(a: Camera, b: Camera) -> np.ndarray:
    """Return F with q_b' F q_a = 0, by Hartley and Zisserman 9.2."""
    T_ba = b.T_cam_world @ np.linalg.inv(a.T_cam_world)
    x, y, z = T_ba[:3, 3]
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.linalg.inv(b.K).T @ cross @ T_ba[:3, :3] @ np.linalg.inv(a.K)


@pytest.mark.parametrize("cameras", [BARRELS, PINHOLES], ids=["barrels", "pinholes"])
def test_partners_lie_on_their_epipolar_curves(cameras: tuple[Camera, Camera]) -> None:
    q = seen(cameras, scene())
    assert np.abs(epipolar_distances(*cameras, q[:, 0], q[:, 1])).max() < 1e-8


def test_pinholes_give_the_distance_from_the_epipolar_line() -> None:
    q_a, q_b = np.moveaxis(seen(PINHOLES, scene()), 1, 0)
    q_b = q_b + np.random.default_rng(4).normal(size=q_b.shape) * 3
    one = np.ones((len(q_a), 1))
    line = np.hstack([q_a, one]) @ fundamental(*PINHOLES).T
    expected = np.abs((np.hstack([q_b, one]) * line).sum(axis=1)) / np.hypot(line[:, 0], line[:, 1])
    assert expected.max() > 3
    found = epipolar_distances(*PINHOLES, q_a, q_b)
    np.testing.assert_allclose(np.abs(found), expected, rtol=0, atol=1e-8)


def test_a_step_across_the_line_is_the_distance() -> None:
    q_a, q_b = np.moveaxis(seen(PINHOLES, scene()), 1, 0)
    line = np.hstack([q_a, np.ones((len(q_a), 1))]) @ fundamental(*PINHOLES).T
    across = line[:, :2] / np.linalg.norm(line[:, :2], axis=1, keepdims=True)
    for step in (0.25, -1.5):
        found = epipolar_distances(*PINHOLES, q_a, q_b + step * across)
        np.testing.assert_allclose(np.abs(found), abs(step), rtol=0, atol=1e-9)
    signs = np.sign(epipolar_distances(*PINHOLES, q_a, q_b + across))
    np.testing.assert_array_equal(np.sign(epipolar_distances(*PINHOLES, q_a, q_b - across)), -signs)


def test_a_small_step_across_a_curve_is_the_distance() -> None:
    p = scene(50)
    q_a, q_b = np.moveaxis(seen(BARRELS, p), 1, 0)
    direction = p - BARRELS[0].centre
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    along = (BARRELS[1].project(p + 0.5 * direction).q - BARRELS[1].project(p - 0.5 * direction).q) / 1.0
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    found = epipolar_distances(*BARRELS, q_a, q_b + 0.01 * across)
    np.testing.assert_allclose(found, 0.01, rtol=0, atol=1e-6)


def test_where_there_is_no_ray_there_is_no_distance() -> None:
    q = seen(BARRELS, scene(3))
    q[0, 0] = 1e6  # beyond the fold
    q[1, 1] = np.nan
    found = epipolar_distances(*BARRELS, q[:, 0], q[:, 1])
    np.testing.assert_array_equal(np.isnan(found), [True, True, False])
    same = epipolar_distances(PINHOLES[0], PINHOLES[0], q[2:, 0], q[2:, 0])
    assert np.isnan(same).all()
