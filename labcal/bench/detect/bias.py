"""Effect of eccentricity on a calibration, without and with its correction.

Nothing is rendered: exact centroids of the dots' outlines come from the camera model, with noise added.
"""

import numpy as np

from labcal.arrays import Pose
from labcal.bench.hand_views import HandViews, dots_at, poses_in_hand
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import DotImages, dot_images
from labcal.correspond.detections import Detections
from labcal.report.bench import Check, at_most
from labcal.rng import generator
from labcal.targets.grid import DotGrid, Rings

VIEWS = 20
TILT_DEG = 60.0
RADIUS_PX = 30.0
NOISE_PX = 0.02
SIZE = (2048, 1536)
LENS = "brown-k1k2"
HARM_LIMIT = 0.5
"""3 sigma over the error without correction: the error is to be more than twice as large."""
SIGMAS_LIMIT = 1.0
"""Error with correction over 3 sigma."""
APART_LIMIT = 0.02
"""Corrected minus calibrated from true centres, over 3 sigma."""
_NAMES = ("fx", "fy", "cx", "cy")


def bench_target() -> DotGrid:
    """Return 14 x 10 dots at 9 mm with a radius of 3 mm."""
    return DotGrid(
        name="bench-bias",
        cols=14,
        rows=10,
        pitch_x_mm=9.0,
        pitch_y_mm=9.0,
        dot_diameter_mm=6.0,
        ring_outer_diameter_mm=6.0,
        ring_inner_diameter_mm=2.0,
        rings=Rings(origin=(2, 2), x=(11, 2), y=(2, 7)),
        margin_mm=9.0,
    )


def bench_camera() -> Camera:
    """Return a camera with some barrel distortion."""
    K = np.array([[1900.0, 0.0, 1031.0], [0.0, 1903.0, 758.0], [0.0, 0.0, 1.0]])
    return Camera(K, LENS, np.array([-0.1, 0.02, 0.0, 0.0, 0.0]), np.eye(4), SIZE)


def bias_checks(seed: int) -> list[Check]:
    """Return the errors of intrinsics with and without eccentricity correction.

    Parameters
    ----------
    seed : int
    """
    target, camera = bench_target(), bench_camera()
    poses = hand_poses(camera, target, seed)
    images = [dot_images(camera, T, target.points(), 0.5 * target.outer_diameters_mm()) for T in poses]
    noise = NOISE_PX * generator(seed, "bench bias", "noise").standard_normal((VIEWS, target.count, 2))
    of_centroids = seen([image.centroid for image in images], images, noise, target)
    of_centres = seen([image.centre for image in images], images, noise, target)
    as_centres = HandheldSettings(eccentricity_rounds=0)
    raw = calibrate_handheld(of_centroids, target, LENS, as_centres)
    corrected = calibrate_handheld(of_centroids, target, LENS)
    ideal = calibrate_handheld(of_centres, target, LENS, as_centres)
    truth = np.array(camera.intrinsics)
    three_sigma = 3.0 * corrected.fits["only"].sigma.intrinsics
    harm = np.abs(_intrinsics(raw) - truth)[:2]
    checks = [
        at_most(
            f"bias: 3 sigma of {name} over its error without correction",
            sigma / error,
            HARM_LIMIT,
        )
        for name, sigma, error in zip(_NAMES[:2], three_sigma[:2], harm, strict=True)
    ]
    left = np.abs(_intrinsics(corrected) - truth) / three_sigma
    apart = np.abs(_intrinsics(corrected) - _intrinsics(ideal)) / three_sigma
    for name, sigmas in zip(_NAMES, left, strict=True):
        checks.append(at_most(f"bias: error of {name} with correction over 3 sigma", sigmas, SIGMAS_LIMIT))
    for name, sigmas in zip(_NAMES, apart, strict=True):
        from_centres = f"bias: {name} with correction against one from true centres, over 3 sigma"
        checks.append(at_most(from_centres, sigmas, APART_LIMIT))
    return checks


def hand_poses(camera: Camera, target: DotGrid, seed: int) -> list[Pose]:
    """Return this benchmark's poses: up to :data:`TILT_DEG`, dots of :data:`RADIUS_PX` in the middle."""
    wanted = HandViews(VIEWS, TILT_DEG, RADIUS_PX)
    return poses_in_hand(camera, target, wanted, generator(seed, "bench bias", "poses"))


def seen(q: list[np.ndarray], images: list[DotImages], noise: np.ndarray, target: DotGrid) -> Detections:
    """Return detections of one camera named ``only`` at pixels (n, 2) by view, with their noise added."""
    noisy = [each + added for each, added in zip(q, noise, strict=True)]
    return dots_at(noisy, [image.ok for image in images], target, SIZE, NOISE_PX)


def _intrinsics(found: HandheldCalibration) -> np.ndarray:
    return np.array(found.rig.camera("only").intrinsics)
