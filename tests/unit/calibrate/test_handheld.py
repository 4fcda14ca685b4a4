"""Calibration from dots that a known rig sees exactly."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from scipy.stats import chi2

from labcal import examples, pipeline
from labcal.calibrate.adjustment.state import Lenses
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.errors import InputError, UnknownNameError
from labcal.targets.grid import DotGrid

See = Callable[..., Detections]
Cameras = dict[str, Camera]
Poses = dict[str, np.ndarray]

CENTRES = HandheldSettings(eccentricity_rounds=0)
"""The pixels are images of centres, not centroids."""


def drop(detections: Detections, views: list[str], camera: str) -> Detections:
    return detections.where(~(np.isin(detections.view, views) & (detections.camera == camera)))


def check_rig(found: Camera, true: Camera) -> None:
    """The adjustment stops within a thousandth of a standard deviation, of which cx has 4 px here."""
    np.testing.assert_allclose(found.K, true.K, rtol=2e-5)
    np.testing.assert_allclose(found.dist[[0, 2, 3]], true.dist[[0, 2, 3]], atol=1e-4)
    np.testing.assert_allclose(found.T_cam_world[:3, :3], true.T_cam_world[:3, :3], atol=1e-5)
    np.testing.assert_allclose(found.T_cam_world[:3, 3], true.T_cam_world[:3, 3], atol=5e-3)


def test_a_known_rig_is_recovered(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> None:
    found = calibrate_handheld(see(pair, grid, poses), grid, "brown5", CENTRES)
    assert tuple(found.rig.cameras) == ("left", "right")
    np.testing.assert_array_equal(found.rig.camera("left").T_cam_world, np.eye(4))
    for name, true in pair.items():
        check_rig(found.rig.camera(name), true)
        assert found.fits[name].views == tuple(poses)
        assert found.fits[name].dots == 8 * grid.count
        assert found.fits[name].rms_px < 1e-4
        assert found.fits[name].rms_in_rig_px < 1e-4
    assert found.rms_px < 1e-4
    assert found.skipped == ()


def test_a_camera_may_miss_views(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> None:
    detections = drop(drop(see(pair, grid, poses), ["pose-0", "pose-1"], "right"), ["pose-6"], "left")
    found = calibrate_handheld(detections, grid, "brown5", CENTRES)
    assert found.fits["left"].views == tuple(f"pose-{i}" for i in (0, 1, 2, 3, 4, 5, 7))
    assert found.fits["right"].views == tuple(f"pose-{i}" for i in (2, 3, 4, 5, 6, 7))
    for name, true in pair.items():
        check_rig(found.rig.camera(name), true)


def test_a_third_camera_joins(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> None:
    T = pair["right"].T_cam_world.copy()
    T[:3, 3] *= [-1, 1, 1]
    T[:3, :3] = T[:3, :3].T
    three = pair | {"third": replace(pair["right"], T_cam_world=T)}
    found = calibrate_handheld(see(three, grid, poses), grid, "brown5", CENTRES)
    for name, true in three.items():
        check_rig(found.rig.camera(name), true)


@pytest.mark.parametrize(("lens", "free"), [("pinhole", 0), ("brown-k1k2", 2)])
def test_a_smaller_lens_frees_fewer_coefficients(
    lens: str,
    free: int,
    see: See,
    pair: Cameras,
    grid: DotGrid,
    poses: Poses,
) -> None:
    dist = np.array([-0.3, 0.1, 0, 0, 0]) * (np.arange(5) < free)
    cameras = {name: replace(camera, lens=lens, dist=dist) for name, camera in pair.items()}
    found = calibrate_handheld(see(cameras, grid, poses), grid, lens, CENTRES)
    for name, true in cameras.items():
        camera = found.rig.camera(name)
        assert camera.lens == lens
        np.testing.assert_allclose(camera.K, true.K, rtol=1e-5)
        np.testing.assert_array_equal(camera.dist[free:], 0)


def test_noise_shows_in_the_rms(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> None:
    exact = see(pair, grid, poses)
    noise = 0.05 * np.random.default_rng(1).normal(size=exact.position.shape)
    found = calibrate_handheld(replace(exact, position=exact.position + noise), grid, "brown-k1k2", CENTRES)
    # The RMS of the 2-D distance is sqrt(2) sigma, less what the unknowns take up.
    for rms in (found.rms_px, found.fits["left"].rms_px, found.fits["right"].rms_px):
        assert 0.85 < rms / (0.05 * np.sqrt(2)) < 1.05


def test_only_ok_dots_enter(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> None:
    exact = see(pair, grid, poses)
    wrong = np.arange(len(exact)) % 7 == 3
    damaged = replace(
        exact,
        position=np.where(wrong[:, None], 1.0, exact.position),
        index=np.where(wrong[:, None], 99, exact.index),
        flag=np.where(wrong, "beyond-grid", exact.flag),
    )
    check_rig(calibrate_handheld(damaged, grid, "brown5", CENTRES).rig.camera("right"), pair["right"])


def test_views_with_few_dots_are_left_out_with_a_reason(
    see: See, pair: Cameras, grid: DotGrid, poses: Poses
) -> None:
    exact = see(pair, grid, poses)
    few = (exact.view == "pose-3") & (exact.camera == "left") & (exact.index.sum(axis=1) > 2)
    found = calibrate_handheld(exact.where(~few), grid, "brown5", CENTRES)
    assert found.skipped == ("view 'pose-3' of camera 'left': only 6 dots, at least 8 are needed",)
    assert "pose-3" not in found.fits["left"].views
    assert "pose-3" in found.fits["right"].views


def test_what_determines_no_camera_is_refused(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> None:
    exact = see(pair, grid, poses)
    with pytest.raises(UnknownNameError, match="'brown-k1k2'"):
        calibrate_handheld(exact, grid, "brown-k1-k2")
    with pytest.raises(InputError, match="no dots with ids"):
        calibrate_handheld(replace(exact, flag=np.full(len(exact), "no-id")), grid, "brown5", CENTRES)
    two = exact.where(np.isin(exact.view, ["pose-0", "pose-1"]))
    with pytest.raises(InputError, match="Camera 'left' has 2 usable views, but needs 3"):
        calibrate_handheld(two, grid, "brown5", CENTRES)
    apart = drop(
        drop(exact, [f"pose-{i}" for i in range(4)], "left"), [f"pose-{i}" for i in range(4, 8)], "right"
    )
    with pytest.raises(InputError, match="'right' and 'left' share no view"):
        calibrate_handheld(apart, grid, "brown5", CENTRES)
    with pytest.raises(InputError, match=r"dot \(4, 0\), but the target 'small' has 4 x 4 dots"):
        calibrate_handheld(exact, grid.model_copy(update={"cols": 4}), "brown5", CENTRES)
    sizes = np.where((exact.view == "pose-2")[:, None], [[480, 640]], exact.size)
    with pytest.raises(InputError, match="camera 'left' differ in size"):
        calibrate_handheld(replace(exact, size=sizes), grid, "brown5", CENTRES)


def test_dots_on_one_line_are_refused(see: See, pair: Cameras, poses: Poses, grid: DotGrid) -> None:
    long = grid.model_copy(update={"cols": 12})
    exact = see(pair, long, poses)
    with pytest.raises(InputError, match="determine no camera"):
        calibrate_handheld(exact.where(exact.index[:, 1] == 0), long, "brown5", CENTRES)


def test_the_same_dots_give_the_same_bytes(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> None:
    # OpenCV's threads would form its sums in another order each time.
    exact = see(pair, grid, poses)
    noisy = replace(
        exact, position=exact.position + 0.1 * np.random.default_rng(1).normal(size=exact.position.shape)
    )
    before = cv2.getNumThreads()
    rigs = {calibrate_handheld(noisy, grid, "brown-k1k2", CENTRES).rig.model_dump_json() for _ in range(2)}
    assert len(rigs) == 1
    assert cv2.getNumThreads() == before


def test_centroids_are_corrected(centroids: See, pair: Cameras, grid: DotGrid, poses: Poses) -> None:
    large = grid.model_copy(update={"dot_diameter_mm": 11.0, "ring_outer_diameter_mm": 11.0})
    true = replace(pair["left"], lens="brown-k1k2", dist=np.array([-0.3, 0.09, 0.0, 0.0, 0.0]))
    detections = centroids({"left": true}, large, poses)
    raw = calibrate_handheld(detections, large, "brown-k1k2", CENTRES)
    found = calibrate_handheld(detections, large, "brown-k1k2")
    assert raw.eccentricity.rms == raw.eccentricity.max == 0.0
    assert 0.02 < found.eccentricity.rms < found.eccentricity.max < 1.0
    assert found.rms_px < 0.01 * raw.rms_px
    off, off_raw = (np.array(f.rig.camera("left").intrinsics) - true.intrinsics for f in (found, raw))
    assert np.abs(off).max() < 0.02 * np.abs(off_raw).max()


@pytest.mark.parametrize("lens", ["fisheye-kb4", "rational8"])
def test_other_lenses_find_their_start(lens: str, centroids: See, grid: DotGrid) -> None:
    dist = {
        "fisheye-kb4": [-0.04, 0.01, -0.006, 0.001, 0.0],
        "rational8": [-0.2, 0.05, 6e-4, -4e-4, 0.0, 0.1, 0.01, 0.0],
    }[lens]
    focal = 260.0 if lens == "fisheye-kb4" else 500.0
    K = np.array([[focal, 0.0, 322.4], [0.0, focal, 237.1], [0.0, 0.0, 1.0]])
    true = Camera(K, lens, np.array(dist), np.eye(4), (640, 480))
    found = calibrate_handheld(centroids({"only": true}, grid, near(grid)), grid, lens)
    assert found.rms_px < 2e-3
    # Coefficients stand in for each other; what counts is where points are imaged.
    p = np.random.default_rng(6).uniform([-60, -45, 100], [60, 45, 140], (200, 3))
    np.testing.assert_allclose(found.rig.camera("only").project(p).q, true.project(p).q, atol=0.05)


def test_a_start_is_refined_or_kept(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> None:
    pair = {name: replace(true, lens="pinhole", dist=np.zeros(5)) for name, true in pair.items()}
    exact = see(pair, grid, poses)
    off = {name: replace(true, K=true.K + np.diag([8.0, -6.0, 0.0])) for name, true in pair.items()}
    start = replace(CENTRES, start=Rig.of(off))
    for name, true in pair.items():
        check_rig(calibrate_handheld(exact, grid, "pinhole", start).rig.camera(name), true)
    kept = calibrate_handheld(exact, grid, "pinhole", replace(start, lenses=Lenses.FIXED))
    for name, given in off.items():
        np.testing.assert_array_equal(kept.rig.camera(name).K, given.K)
        np.testing.assert_array_equal(kept.rig.camera(name).dist, given.dist)
        assert kept.fits[name].sigma.intrinsics.max() == 0.0
    right = replace(CENTRES, start=Rig.of(pair), lenses=Lenses.FIXED)
    two = exact.where(np.isin(exact.view, ["pose-0", "pose-1"]))  # enough where the lenses are known
    np.testing.assert_allclose(
        calibrate_handheld(two, grid, "pinhole", right).rig.camera("right").T_cam_world,
        pair["right"].T_cam_world,
        atol=1e-4,
    )


def test_a_start_may_be_the_path_of_a_rig(pair: Cameras, tmp_path: Path) -> None:
    file = tmp_path / "rig.json"
    Rig.of(pair).save(file)
    for given in (file, str(file)):
        assert HandheldSettings(start=given, lenses="fixed").start_rig == Rig.load(file)
    with pytest.raises(InputError, match="missing"):
        HandheldSettings(start=tmp_path / "missing.json")


def test_a_start_that_does_not_fit_is_refused(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> None:
    exact = see(pair, grid, poses)
    start = HandheldSettings(start=Rig.of(pair))
    with pytest.raises(InputError, match="from which 'fisheye-kb4' cannot start"):
        calibrate_handheld(exact, grid, "fisheye-kb4", start)
    with pytest.raises(InputError, match="from which 'brown-k1k2' cannot start"):
        calibrate_handheld(exact, grid, "brown-k1k2", start)
    with pytest.raises(InputError, match="no camera in the rig named 'left'"):
        calibrate_handheld(exact, grid, "brown5", replace(start, start=Rig.of({"right": pair["right"]})))
    wide = {name: replace(camera, size=(800, 600)) for name, camera in pair.items()}
    with pytest.raises(InputError, match="takes pictures of 800 x 600, but these are 640 x 480"):
        calibrate_handheld(exact, grid, "brown5", replace(start, start=Rig.of(wide)))
    with pytest.raises(InputError, match="Give that rig: `start="):
        calibrate_handheld(exact, grid, "brown5", HandheldSettings(lenses=Lenses.FIXED))
    with pytest.raises(InputError, match="nothing in it to calibrate"):
        calibrate_handheld(exact, grid, "prescription")


def test_stated_sigmas_are_those_of_repeated_calibrations(
    see: See, pair: Cameras, grid: DotGrid, poses: Poses
) -> None:
    """Chi-square of four intrinsics over 12 noisy repetitions of a pinhole camera."""
    true = replace(pair["left"], lens="pinhole", dist=np.zeros(5))
    exact = see({"left": true}, grid, poses)
    random = np.random.default_rng(8)
    z = []
    for _ in range(12):
        noisy = replace(exact, position=exact.position + 0.1 * random.normal(size=exact.position.shape))
        found = calibrate_handheld(noisy, grid, "pinhole", CENTRES)
        off = np.array(found.rig.camera("left").intrinsics) - true.intrinsics
        z.append(off / found.fits["left"].sigma.intrinsics)
    for square in (np.array(z) ** 2).sum(axis=0):
        assert 0.001 < chi2.sf(square, 12) < 0.999


def near(grid: DotGrid) -> Poses:
    """Return seven poses that fill a wide picture."""
    random = np.random.default_rng(31)
    middle = grid.points().mean(axis=0)
    found = {}
    for number in range(7):
        tilt, _ = cv2.Rodrigues(random.normal(0.0, 0.35, 3))
        T = np.eye(4)
        T[:3, :3] = np.diag([1.0, -1.0, -1.0]) @ tilt
        T[:3, 3] = random.uniform([-35, -25, 90], [35, 25, 130]) - T[:3, :3] @ middle
        found[f"pose-{number}"] = T
    return found


def test_a_rig_that_explains_nothing_is_refused(
    see: See, pair: Cameras, grid: DotGrid, poses: Poses, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("labcal.calibrate.assembled.MOST_OFF", 1e-9)
    with pytest.raises(InputError, match=r"No rig explains the dots.*the target 'small'"):
        calibrate_handheld(see(pair, grid, poses), grid, "brown5", CENTRES)


def test_dots_that_scatter_far_beyond_their_noise_are_uneven(
    see: See, pair: Cameras, grid: DotGrid, poses: Poses
) -> None:
    exact = see(pair, grid, poses)
    sharp = replace(exact, covariance=1e-4 * exact.covariance / exact.covariance[0, 0, 0])
    off = np.random.default_rng(2).normal(0.0, 0.4, (grid.count, 2))
    place = exact.index[:, 1] * grid.cols + exact.index[:, 0]
    printed = replace(sharp, position=sharp.position + off[place])
    declared = replace(CENTRES, dot_places="declared")
    for dots, uneven in ((sharp, False), (printed, True)):
        fits = calibrate_handheld(dots, grid, "brown5", declared).fits.values()
        assert {fit.uneven for fit in fits} == {uneven}


def test_the_first_camera_is_the_world_also_where_its_first_picture_has_no_measured_dot() -> None:
    """Of 30 drawn sets one began with a refused picture: the cameras changed places."""
    dots = examples.detections()
    first = (dots.view == dots.views[0]) & (dots.camera == dots.cameras[0])
    spoilt = replace(dots, flag=np.where(first, "bad-fit", dots.flag))
    rig = pipeline.calibrate(examples.TARGET, spoilt).rig
    assert tuple(rig.cameras) == dots.cameras
    assert np.array_equal(rig.camera(dots.cameras[0]).T_cam_world, np.eye(4))
