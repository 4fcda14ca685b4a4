"""Where no lens is named, the usual one is taken unless the views ask for another."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from labcal.bench.solve.budget_rigs import KINDS
from labcal.bench.solve.pair_dots import pair_dots
from labcal.calibrate.calibrated import calibrated
from labcal.calibrate.calibration import Calibration
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.lens_candidates import DEFAULT_LENS
from labcal.cameras.calibration_share import calibration_share
from labcal.cameras.camera import Camera
from labcal.cameras.triangulation import triangulate
from labcal.correspond.detections import Detections
from labcal.evaluate.statistics import coverage
from labcal.targets.grid import DotGrid

See = Callable[..., Detections]
NOISE_PX = 0.05
SETTINGS = HandheldSettings(eccentricity_rounds=0, dot_places="declared")


def dots_of_pair(kind: str, lens: str, dist: list[float]) -> Detections:
    """Return dots of twelve views by a pair of cameras with a lens of that kind."""
    of, random = KINDS[kind], np.random.default_rng(5)
    cameras = [replace(camera, lens=lens, dist=np.array(dist)) for camera in of.cameras()]
    target, views = of.target(), of.poses(12, random)
    return pair_dots(cameras, target, target.points(), views, (NOISE_PX, random))


@pytest.fixture(scope="module")
def plain() -> tuple[Detections, DotGrid]:
    return dots_of_pair("webcam", "brown5", [0.08, -0.2, 1e-3, -5e-4, 0.02]), KINDS["webcam"].target()


@pytest.fixture(scope="module")
def usual(plain: tuple[Detections, DotGrid]) -> Calibration:
    return calibrated(*plain, settings=SETTINGS)


@pytest.fixture(scope="module")
def too_simple(plain: tuple[Detections, DotGrid]) -> Calibration:
    return calibrated(*plain, "brown-k1k2", SETTINGS)


def test_the_usual_lens_stays_with_the_same_bytes_where_it_suits(
    usual: Calibration, plain: tuple[Detections, DotGrid]
) -> None:
    assert usual.lens == DEFAULT_LENS
    assert usual.choice is not None
    assert usual.choice.trials == ()  # nothing else was tried
    assert "the views ask for no more coefficients" in usual.choice.why
    named = calibrated(*plain, DEFAULT_LENS, SETTINGS)
    assert named.choice is None
    assert named.rig.model_dump_json() == usual.rig.model_dump_json()


@pytest.mark.slow
def test_missing_coefficients_are_noticed_and_held_out_views_choose() -> None:
    prism = [-0.2, 0.06, 4e-4, -3e-4, -0.006, 0.0, 0.0, 0.0, 0.02, -0.08, 0.04, 0.06]
    dots, target = dots_of_pair("webcam", "thin-prism12", prism), KINDS["webcam"].target()
    found = calibrated(dots, target, settings=SETTINGS)
    assert found.lens == "thin-prism12"
    assert found.choice is not None
    assert "ask for 'thin-prism12'" in found.choice.why
    assert {trial.lens for trial in found.choice.trials} >= {DEFAULT_LENS, "thin-prism12"}
    named = calibrated(dots, target, DEFAULT_LENS, SETTINGS)
    assert named.lens == DEFAULT_LENS  # a named one wins
    assert any("'brown5' is too simple" in warning for warning in named.warnings)
    assert found.found.rms_px < 0.9 * named.found.rms_px


def test_a_fisheye_is_noticed(centroids: See, grid: DotGrid) -> None:
    K = np.array([[170.0, 0.0, 322.4], [0.0, 170.0, 237.1], [0.0, 0.0, 1.0]])
    true = Camera(K, "fisheye-kb4", np.array([-0.04, 0.01, -0.006, 0.001, 0.0]), np.eye(4), (640, 480))
    random = np.random.default_rng(31)
    poses = {}
    for number in range(10):
        a, b = 0.5 * np.array([np.cos(number), np.sin(number)])
        R = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
        R = R @ np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
        T = np.eye(4)
        T[:3, :3] = np.diag([1.0, -1.0, -1.0]) @ R
        T[:3, 3] = random.uniform([-60, -45, 45], [60, 45, 80]) - T[:3, :3] @ grid.points().mean(axis=0)
        poses[f"pose-{number}"] = T
    exact = centroids({"only": true}, grid, poses)
    noisy = replace(exact, position=exact.position + 0.03 * random.normal(size=exact.position.shape))
    found = calibrated(noisy, grid)
    assert found.lens == "fisheye-kb4"
    assert found.choice is not None
    assert found.choice.why
    assert found.rig.camera("only").K[0, 0] == pytest.approx(170.0, rel=0.01)


def test_too_few_views_keep_the_usual_lens(plain: tuple[Detections, DotGrid]) -> None:
    dots, target = plain
    some = dots.where(np.isin(dots.view, dots.views[:4]))
    found = calibrated(some, target, settings=SETTINGS)
    assert found.lens == DEFAULT_LENS
    assert found.choice is not None
    assert "4 views of a camera are too few" in found.choice.why


def test_a_simple_lens_that_is_named_is_warned_of_and_is_no_surer_than_the_larger_one(
    too_simple: Calibration, usual: Calibration
) -> None:
    misfits = [fit.misfit for fit in too_simple.found.fits.values()]
    assert any(misfit is not None and misfit.larger == "brown5" for misfit in misfits)
    assert any("'brown-k1k2' is too simple" in warning for warning in too_simple.warnings)
    assert usual.found.sources.omitted.shape[1] == 0
    assert too_simple.found.sources.omitted.shape[1] == 6  # p1, p2, k3 of two cameras


def test_points_of_a_simple_lens_through_a_long_one_are_covered() -> None:
    """Residuals do not tell decentring there: it moves poses and principal points, and all points alike."""
    kind, random = KINDS["narrow"], np.random.default_rng(5)
    target, views = kind.target(), kind.poses(8, random)
    dots = pair_dots(kind.cameras(), target, target.points(), views, (NOISE_PX, random))
    made = calibrate_handheld(dots, target, "brown-k1k2", SETTINGS)
    true = kind.points(50, random)
    q = np.stack([camera.project(true).q for camera in kind.cameras()], axis=1)
    found = [made.rig.camera(name) for name in made.rig.cameras]
    pixels = np.tile(1e-6 * np.eye(2), (*q.shape[:2], 1, 1))
    point = triangulate(found, q, pixels).point
    assert made.rig.covariance is not None
    for stated, holds in ((made.rig.covariance.matrix, True), (made.covariance.covariance, False)):
        share = calibration_share(found, stated, point, pixels)
        assert (coverage(point - true, share) > 0.88) == holds  # the latter without the share of the lens
