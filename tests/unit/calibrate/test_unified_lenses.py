"""Lenses of the unified family calibrated from dots that were seen through them."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.lens_start import camera_as_lens
from labcal.calibrate.resection.lens_choice import camera_of_lens
from labcal.calibrate.resection.resected import resect
from labcal.cameras.camera import Camera
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.geometry.poses import from_rotation_vector, rotation_vector
from labcal.targets.catalogue import load_target

See = Callable[..., Detections]
NOISE_PX = 0.02
TARGET = load_target("paper-13x10")
SECOND_FROM_FIRST = from_rotation_vector(np.array([0.02, 0.25, -0.03]), np.array([-120.0, 6.0, 25.0]))
LENSES = {
    "double-sphere": ((-0.2, 0.6), 170.0),
    "eucm": ((0.6, 1.1), 200.0),
    "omni-radtan": ((1.2, -0.1, 0.02, 6e-4, -4e-4), 435.0),
}


def rig(lens: str) -> dict[str, Camera]:
    """Return two cameras of some 190 degrees along the diagonal."""
    dist, focal = LENSES[lens]
    K = np.array([[focal, 0.0, 322.4], [0.0, 1.01 * focal, 237.1], [0.0, 0.0, 1.0]])
    padded = np.array([*dist, *(0.0,) * (5 - len(dist))])
    return {
        "left": Camera(K, lens, padded, np.eye(4), (640, 480)),
        "right": Camera(K - np.diag([3.0, 2.0, 0.0]), lens, padded * 0.98, SECOND_FROM_FIRST, (640, 480)),
    }


def near_poses() -> dict[str, np.ndarray]:
    """Return places of a target that is held near, so that it reaches far out in the pictures."""
    random = np.random.default_rng(8)
    middle = TARGET.points().mean(axis=0)
    found = {}
    for number in range(12):
        tilt = from_rotation_vector(random.normal(0.0, 0.35, 3), np.zeros(3))[:3, :3]
        T = np.eye(4)
        T[:3, :3] = np.diag([1.0, -1.0, -1.0]) @ tilt
        T[:3, 3] = random.uniform([-160, -120, 140], [340, 120, 280]) - T[:3, :3] @ middle
        found[f"pose-{number}"] = T
    return found


def off(found: Camera, true: Camera) -> tuple[np.ndarray, np.ndarray]:
    """Return how far intrinsics and coefficients, and the rotation and the shift, are from the truth."""
    free = found.model.coefficients
    lens = [*np.subtract(found.intrinsics, true.intrinsics), *(found.dist - true.dist)[:free]]
    step = found.T_cam_world @ np.linalg.inv(true.T_cam_world)
    return np.array(lens), np.array([*rotation_vector(step), *(found.T_cam_world - true.T_cam_world)[:3, 3]])


@pytest.mark.parametrize("lens", LENSES)
def test_a_rig_is_found_within_three_standard_deviations(centroids: See, lens: str) -> None:
    true = rig(lens)
    seen = centroids(true, TARGET, near_poses())
    noise = NOISE_PX * np.random.default_rng(2).normal(size=seen.position.shape)
    covariance = np.tile(NOISE_PX**2 * np.eye(2), (len(noise), 1, 1))
    noisy = replace(seen, position=seen.position + noise, covariance=covariance)
    found = calibrate_handheld(noisy, TARGET, lens, HandheldSettings())
    for name, camera in true.items():
        fit, calibrated = found.fits[name], found.rig.camera(name)
        assert calibrated.lens == lens
        assert not fit.open_lens
        assert fit.rms_px < 1.1 * np.sqrt(2.0) * NOISE_PX
        of_lens, of_place = off(calibrated, camera)
        assert (np.abs(of_lens) < 3.0 * np.array([*fit.sigma.intrinsics, *fit.sigma.dist])).all()
        if name != "left":
            assert (
                np.abs(of_place) < 3.0 * np.array([*fit.sigma.rotation_rad, *fit.sigma.translation_mm])
            ).all()


@pytest.mark.parametrize("lens", LENSES)
def test_a_camera_is_found_from_points_in_space(lens: str) -> None:
    camera = rig(lens)["right"]
    random = np.random.default_rng(4)
    rays = camera.rays(random.uniform([20.0, 20.0], [620.0, 460.0], (250, 2)))
    p = rays.origin + random.uniform(200.0, 900.0, (250, 1)) * rays.direction
    found = resect("bundle", camera.project(p).q, p, camera_of_lens(lens, camera.size, None)).camera
    np.testing.assert_allclose(found.project(p).q, camera.project(p).q, rtol=0, atol=1e-3)
    np.testing.assert_allclose(found.dist, camera.dist, rtol=1e-3, atol=1e-4)


def test_without_distortion_a_lens_is_no_list_of_zeros() -> None:
    """Estimates begin where all directions are imaged: zeros are a pinhole, or no lens at all."""
    for lens, expected in (("double-sphere", (-0.2, 0.5)), ("eucm", (0.5, 1.0)), ("omni-radtan", (1.0, 0.0))):
        start = camera_of_lens(lens, (640, 480), None)
        np.testing.assert_array_equal(start.dist[:2], expected)
        assert start.project(np.array([[700.0, 0.0, -400.0]])).ok.all()


def test_a_rig_to_start_from_keeps_its_lens() -> None:
    known = rig("eucm")["left"]
    assert camera_as_lens(known, "eucm", "left") is known
    with pytest.raises(InputError, match="from which 'double-sphere' cannot start"):
        camera_as_lens(known, "double-sphere", "left")
