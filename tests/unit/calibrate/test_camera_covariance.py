"""The error of points by the cameras' uncertainty, against calibrations of many drawings of the noise."""

import numpy as np
import pytest

from labcal import examples, load_target, pipeline
from labcal.calibrate.camera_covariance import CameraCovariance
from labcal.cameras.camera import Camera
from labcal.cameras.triangulation import triangulate
from labcal.correspond.detections import Detections
from labcal.geometry.poses import rigid_alignment, transform

RUNS = 16


def drawn(dots: Detections, clean: np.ndarray, rng: np.random.Generator) -> Detections:
    """Return detections with other noise."""
    q = clean + rng.normal(0.0, examples.SIGMA_PX, clean.shape)
    return Detections(
        dots.view, dots.camera, dots.image, dots.size, dots.index, dots.has_id,
        np.where(dots.ok[:, None], q, np.nan), dots.covariance, dots.flag,
    )  # fmt: skip


@pytest.fixture(scope="module")
def clean() -> np.ndarray:
    """The centroids of the example without noise, (n, 2), px."""
    target = examples._target()
    seen = [seen.centroid for _, _, seen in examples._seen(examples._VIEWS)]
    assert len(seen[0]) == target.count
    return np.concatenate(seen)


@pytest.mark.slow
def test_points_scatter_between_calibrations_as_is_stated(clean: np.ndarray) -> None:
    target, dots = load_target(examples.TARGET), examples.detections()
    rng, errors, stated = np.random.default_rng(3), [], []
    true = [examples.rig().camera(name) for name in ("left", "right")]
    grid = np.stack(np.meshgrid([-60.0, 20.0, 100.0], [-50.0, 50.0], [550.0, 700.0]), axis=-1).reshape(-1, 3)
    q = np.stack([camera.project(grid).q for camera in true], axis=1)
    for _ in range(RUNS):
        found = pipeline.calibrate(target, drawn(dots, clean, rng), "brown5").found
        cameras = [found.rig.camera(name) for name in found.rig.cameras]
        p = triangulate(cameras, q, np.tile(np.eye(2), (len(q), 2, 1, 1))).point
        off = transform(rigid_alignment(grid, p), p) - grid
        errors.append(float((off**2).sum(axis=1).mean()))
        stated.append(found.covariance.rms_mm(cameras, grid) ** 2)
    ratio = np.mean(errors) / np.mean(stated)
    # A mean of squares along few directions scatters as chi-square of few degrees of freedom, 16 times.
    assert 0.5 < ratio < 1.8
    assert np.ptp(stated) < 0.3 * np.mean(stated)


def pair(angle: float) -> list[Camera]:
    K = [[800.0, 0.0, 320.0], [0.0, 800.0, 240.0], [0.0, 0.0, 1.0]]
    R = np.array([[np.cos(angle), 0, -np.sin(angle)], [0, 1, 0], [np.sin(angle), 0, np.cos(angle)]])
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, -R @ [200.0, 0.0, 0.0]
    return [Camera(K, "pinhole", [0] * 5, pose, (640, 480)) for pose in (np.eye(4), T)]


def test_a_turned_camera_moves_points_as_triangulation_says() -> None:
    sigma, angle = 1e-5, 0.2
    covariance = np.zeros((6, 6))
    covariance[1, 1] = sigma**2  # about its own y
    fixed, none = slice(0, 0), slice(0, 0)
    of = CameraCovariance(covariance, (fixed, fixed), (none, slice(0, 6)))
    rng = np.random.default_rng(0)
    p = rng.uniform([-50, -50, 600], [150, 50, 900], (40, 3))
    q = np.stack([camera.project(p).q for camera in pair(angle)], axis=1)
    # The camera is turned by sigma: R changes to exp(w) R, a turn about the camera's own axis; t stays.
    first, second = pair(angle)
    T = second.T_cam_world.copy()
    turn = np.array([[1, 0, sigma], [0, 1, 0], [-sigma, 0, 1]])
    T[:3, :3] = turn @ T[:3, :3]
    moved = Camera(second.K, "pinhole", second.dist, T, second.size)
    found = triangulate([first, moved], q, np.tile(np.eye(2), (len(q), 2, 1, 1))).point
    off = transform(rigid_alignment(p, found), found) - p
    expected = float(np.sqrt((off**2).sum(axis=1).mean()))
    assert of.rms_mm([first, second], p) == pytest.approx(expected, rel=1e-3)
    assert expected > 0.001


def test_what_the_views_leave_open_is_not_stated() -> None:
    covariance = np.full((6, 6), np.nan)
    of = CameraCovariance(covariance, (slice(0, 0), slice(0, 0)), (slice(0, 0), slice(0, 6)))
    p = np.random.default_rng(0).uniform([-50, -50, 600], [150, 50, 900], (40, 3))
    assert np.isnan(of.rms_mm(pair(0.2), p))
