"""Cameras with parallel rays calibrated: what they tell, and what no picture tells of them."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from labcal.calibrate.calibrated import calibrated
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.calibrate.parallel_rig import parallel_notes, with_determined_poses
from labcal.calibrate.resection.lens_choice import camera_of_lens
from labcal.calibrate.resection.resected import resect
from labcal.calibrate.rig_start import SingleCamera
from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.cameras.triangulation import triangulate
from labcal.correspond.detections import Detections
from labcal.correspond.matching import match
from labcal.errors import InputError
from labcal.geometry.parallel_pose import mirrored, parallel_plane_pose
from labcal.geometry.poses import from_rotation_vector, rigid_alignment, rotation_vector
from labcal.report.calibrate_result import calibrate_result
from labcal.targets.catalogue import load_target

See = Callable[..., Detections]
NOISE_PX = 0.02
TARGET = load_target("rings-10x8")
SIZE = (1280, 960)
K = np.array([[12.0, 0.0, 639.5], [0.0, 12.1, 479.5], [0.0, 0.0, 1.0]])
DIST = np.array([-1.2e-5, 2e-9, 4e-6, -6e-6, -3e-13])
"""Some 25 px in the corners, 66 mm from the axis."""
DEPTH_MM = 500.0
TURN = np.array([0.05, 0.5, -0.03])


def second(turn: np.ndarray) -> Camera:
    """Return a camera, turned as given, whose axis meets the first one's at DEPTH_MM."""
    T = from_rotation_vector(turn, np.zeros(3))
    T[:3, 3] = [0.0, 0.0, DEPTH_MM] - T[:3, 2] * DEPTH_MM
    return Camera(K - np.diag([0.3, 0.2, 0.0]), "telecentric", 0.9 * DIST, T, SIZE)


def rig(turn: np.ndarray = TURN) -> dict[str, Camera]:
    """Return two cameras; the second one looks from the right where it turns by a positive angle about y."""
    return {"left": Camera(K, "telecentric", DIST, np.eye(4), SIZE), "right": second(turn)}


def poses(count: int = 10) -> dict[str, np.ndarray]:
    """Return places of a target that is held amid both cameras' fields, tilted every way."""
    random = np.random.default_rng(8)
    middle, found = TARGET.points().mean(axis=0), {}
    for number in range(count):
        T = from_rotation_vector(random.normal(0.0, 0.3, 3), np.zeros(3))
        towards = from_rotation_vector(-0.5 * TURN, np.zeros(3))[:3, :3]
        T[:3, :3] = towards @ np.diag([1.0, -1.0, -1.0]) @ T[:3, :3]
        T[:3, 3] = random.uniform([-25, -18, DEPTH_MM - 12], [25, 18, DEPTH_MM + 12]) - T[:3, :3] @ middle
        found[f"pose-{number}"] = T
    return found


def seen(centroids: See, cameras: dict[str, Camera]) -> Detections:
    dots = centroids(cameras, TARGET, poses())
    noise = NOISE_PX * np.random.default_rng(2).normal(size=dots.position.shape)
    covariance = np.tile(NOISE_PX**2 * np.eye(2), (len(noise), 1, 1))
    return replace(dots, position=dots.position + noise, covariance=covariance)


def require_found(found: HandheldCalibration, true: dict[str, Camera]) -> None:
    """Raise unless intrinsics, coefficients and the turn are within three standard deviations."""
    for name, camera in true.items():
        fit, got = found.fits[name], found.rig.camera(name)
        assert fit.rms_in_rig_px < 1.1 * np.sqrt(2.0) * NOISE_PX
        off = np.array([*np.subtract(got.intrinsics, camera.intrinsics)[:2], *(got.dist - camera.dist)])
        assert (np.abs(off) < 3.0 * np.array([*fit.sigma.intrinsics[:2], *fit.sigma.dist])).all()
        assert got.intrinsics[2:] == (639.5, 479.5)
        assert fit.sigma.intrinsics[2:].tolist() == [0.0, 0.0]
        assert fit.sigma.translation_mm[2] == 0.0
    turn = rotation_vector(got.T_cam_world @ np.linalg.inv(camera.T_cam_world))
    assert (np.abs(turn) < 3.0 * fit.sigma.rotation_rad).all()


def test_a_rig_is_found_and_its_points_are_where_they_were(centroids: See) -> None:
    true = rig()
    dots = seen(centroids, true)
    told = calibrated(dots, TARGET, "telecentric")
    require_found(told.found, true)
    assert any("the mirror image of this rig explains the dots as well" in one for one in told.warnings)
    assert any("parallel rays determine no depth" in one for one in told.warnings)
    document = calibrate_result(told, dots, TARGET)
    assert any("that the views of several cameras agree was not tested" in one for one in document.warnings)
    matches = match(dots, ("left", "right"))
    p = triangulate([told.rig.camera(name) for name in true], matches.q, matches.covariance).point
    T = np.stack([poses()[view] for view in matches.view.tolist()])
    expected = np.einsum("nij,nj->ni", T[:, :3, :3], TARGET.points(matches.index)) + T[:, :3, 3]
    aligned = rigid_alignment(expected, p)
    left = expected - (p @ aligned[:3, :3].T + aligned[:3, 3])
    assert np.sqrt((left**2).sum(axis=1).mean()) < 0.02  # mm; the mirror image would leave tens


def test_a_rig_to_start_from_tells_it_from_its_mirror_image(centroids: See) -> None:
    true = rig(-TURN)
    dots = seen(centroids, true)
    there = {"left": true["left"], "right": second(-TURN + np.array([0.05, 0.03, 0.02]))}
    settings = HandheldSettings(start=Rig.of(there))
    require_found(calibrate_handheld(dots, TARGET, "telecentric", settings), true)
    assert not any("mirror image" in one for one in parallel_notes(Rig.of(true), started=True))
    unknown = calibrate_handheld(dots, TARGET, "telecentric").rig.camera("right").T_cam_world
    S = np.diag([1.0, 1.0, -1.0])
    np.testing.assert_allclose(unknown[:3, :3], S @ true["right"].T_cam_world[:3, :3] @ S, rtol=0, atol=1e-3)


def test_beside_a_camera_that_sees_depth_there_is_no_mirror_image() -> None:
    true = rig(-TURN)
    pinhole = np.array([[4000.0, 0.0, 639.5], [0.0, 4000.0, 479.5], [0.0, 0.0, 1.0]])
    left = Camera(pinhole, "pinhole", np.zeros(5), np.eye(4), SIZE)
    assert len(parallel_notes(Rig.of({**true, "left": left}), started=False)) == 1
    views = np.arange(6)
    first = np.stack(list(poses(6).values()))
    other = true["right"].T_cam_world @ first
    blind = np.stack([mirrored(T) if view % 2 else T for view, T in enumerate(other)])
    blind[:, 2, 3] += 7.0 * views
    single = [SingleCamera("left", left, views, first), SingleCamera("right", true["right"], views, blind)]
    told = with_determined_poses(single, None)
    np.testing.assert_array_equal(told[0].T_cam_target, first)
    T = told[1].T_cam_target @ np.linalg.inv(first)
    expected = np.tile(true["right"].T_cam_world, (6, 1, 1))
    np.testing.assert_allclose(T[:, :3, :3], expected[:, :3, :3], rtol=0, atol=1e-9)
    np.testing.assert_allclose(T[:, :2, 3], expected[:, :2, 3], rtol=0, atol=1e-7)
    np.testing.assert_allclose(T[:, 2, 3], T[0, 2, 3], rtol=0, atol=1e-7)  # at some depth, the same in all


def test_one_camera_says_what_it_cannot_tell(centroids: See) -> None:
    dots = seen(centroids, rig())
    told = calibrated(dots.where(dots.camera == "left"), TARGET, "telecentric")
    assert any("does not determine to which side the target was tilted" in one for one in told.warnings)
    camera, sigma = told.rig.camera("left"), told.found.fits["left"].sigma
    off = np.array([*np.subtract(camera.intrinsics, rig()["left"].intrinsics)[:2], *(camera.dist - DIST)])
    assert (np.abs(off) < 3.0 * np.array([*sigma.intrinsics[:2], *sigma.dist])).all()


def test_dots_cannot_be_freed(centroids: See) -> None:
    freed = HandheldSettings(dot_places="freed")
    with pytest.raises(InputError, match="Dots cannot be freed behind the lens 'telecentric'"):
        calibrate_handheld(seen(centroids, rig()), TARGET, "telecentric", freed)


def test_a_camera_is_found_from_points_in_space() -> None:
    camera, random = second(TURN), np.random.default_rng(4)
    rays = camera.rays(random.uniform([20.0, 20.0], [1260.0, 940.0], (300, 2)))
    p = rays.origin + random.uniform(400.0, 600.0, (300, 1)) * rays.direction
    q = camera.project(p).q + NOISE_PX * random.normal(size=(300, 2))
    found = resect("bundle", q, p, camera_of_lens("telecentric", SIZE, None))
    sigma = np.sqrt(np.diagonal(found.covariance))
    assert sigma[5] == 0.0  # mm, of the depth, which is held
    assert found.sigma_px == pytest.approx(NOISE_PX, rel=0.1)
    off = [*np.subtract(found.camera.intrinsics, camera.intrinsics)[:2], *(found.camera.dist - camera.dist)]
    assert (np.abs(off) < 3.0 * sigma[6:]).all()


def test_a_plane_has_two_poses_that_look_the_same() -> None:
    T = poses(1)["pose-0"]
    plane = TARGET.points()
    across = (plane @ T[:3, :3].T + T[:3, 3])[:, :2]
    one = parallel_plane_pose(across, plane[:, :2], T[2, 3])
    other = mirrored(one)
    assert np.linalg.det(other[:3, :3]) == pytest.approx(1.0)
    np.testing.assert_allclose((plane @ other[:3, :3].T + other[:3, 3])[:, :2], across, rtol=0, atol=1e-9)
    assert min(np.abs(one - T).max(), np.abs(other - T).max()) < 1e-9
    assert np.abs(one - other).max() > 0.05
    with pytest.raises(InputError, match="span 2 dimensions"):
        parallel_plane_pose(across[:4], plane[:4, :2] * [1.0, 0.0], 0.0)
