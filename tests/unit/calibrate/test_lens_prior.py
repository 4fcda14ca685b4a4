"""What dots leave open of a lens neither folds it inside the picture nor gives it absurd coefficients."""

import cv2
import numpy as np
import pytest

from labcal.bench.detect.bias import bench_target
from labcal.bench.hand_views import dots_at
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.lens_prior import FoundLens, PriorWidth, coefficient_weights, narrow_is_better
from labcal.calibrate.resection.lens_choice import camera_of_lens
from labcal.calibrate.resection.resected import NEAR, adjusted, resect
from labcal.cameras.camera import Camera
from labcal.geometry.poses import transform
from labcal.optim.whitening import CorrelatedNoise

SIZE = (1280, 960)
K = np.array([[1200.0, 0.0, 643.0], [0.0, 1201.0, 476.0], [0.0, 0.0, 1.0]])
NOISE_PX = 0.1
TRUE = {
    "mild": ("brown-k1k2", [-0.1, 0.02, 0.0, 0.0, 0.0]),
    "brown5": ("brown5", [-0.25, 0.09, 6e-4, -4e-4, 0.01]),
    "rational8": ("rational8", [0.4, -0.2, 3e-4, -2e-4, 0.01, 0.55, -0.12, 0.005]),
    "thin-prism12": (
        "thin-prism12",
        [-0.2, 0.05, 3e-4, -2e-4, 0.0, 0.0, 0.0, 0.0, 0.003, -0.001, -0.002, 0.001],
    ),
    "tilted14": ("tilted14", [-0.2, 0.05, 3e-4, -2e-4, *[0.0] * 8, 0.05, -0.03]),
    "fisheye-kb4": ("fisheye-kb4", [0.02, -0.004, 0.001, 0.0, 0.0]),
}
CASES = [
    ("mild", "rational8", 0.75),
    ("mild", "brown5", 0.45),
    ("rational8", "rational8", 0.75),
    ("thin-prism12", "thin-prism12", 0.75),
    pytest.param("tilted14", "tilted14", 0.75, marks=pytest.mark.slow),
    ("fisheye-kb4", "fisheye-kb4", 0.45),
]
"""The true lens, the model, and which part of the picture dots cover."""


def true_camera(name: str) -> Camera:
    lens, dist = TRUE[name]
    return Camera(K, lens, np.array(dist, dtype=np.float64), np.eye(4), SIZE)


def seen(camera: Camera, count: int, share: float, random: np.random.Generator) -> np.ndarray:
    """Return points that a camera sees in the middle part of its picture, on four planes, mm."""
    q = np.array(SIZE) * random.uniform(0.5 - 0.5 * share, 0.5 + 0.5 * share, (count, 2))
    rays = camera.rays(q)
    depth = random.choice([900.0, 1100.0, 1300.0, 1500.0], count)
    return rays.origin + rays.direction * (depth / rays.direction[:, 2])[:, None]


@pytest.mark.parametrize(("true", "lens", "share"), CASES)
@pytest.mark.parametrize("seed", [0, 1])
def test_a_resected_lens_images_the_whole_picture(true: str, lens: str, share: float, seed: int) -> None:
    """On 130 dots with 0.1 px noise, half of these had points in the picture without an image."""
    random, camera, count = np.random.default_rng(seed), true_camera(true), 130
    p = seen(camera, count, share, random)
    q = camera.project(p).q + random.normal(0.0, NOISE_PX, (count, 2))
    fitted = resect("bundle", q, p, camera_of_lens(lens, SIZE, None))
    found = fitted.camera
    assert found.share_without_rays == 0.0
    assert np.abs(found.dist).max() < 2.0
    assert found.project(seen(camera, 1000, 1.0, random)).ok.all()
    inside = seen(camera, 1000, share, random)
    error = np.linalg.norm(found.project(inside).q - camera.project(inside).q, axis=1)
    # The noise that fitted parameters take up; its own scatter is a sixth of it.
    assert np.sqrt((error**2).mean()) < 1.6 * NOISE_PX * np.sqrt(fitted.placed.count / count)


def test_the_lens_of_a_hybrid_images_the_whole_picture() -> None:
    random, camera = np.random.default_rng(3), true_camera("mild")
    p = seen(camera, 130, 0.75, random)
    q = camera.project(p).q + random.normal(0.0, NOISE_PX, (130, 2))
    start = resect("hybrid", q, p, camera_of_lens("rational8", SIZE, None))
    # As correlated noise asks for it, from another place.
    again = adjusted(start.placed, q, p, CorrelatedNoise(NOISE_PX * np.eye(len(p))), NEAR)
    assert again.camera.share_without_rays == 0.0
    assert np.abs(again.camera.dist).max() < 2.0


@pytest.mark.parametrize("lens", ["brown5", "fisheye-kb4"])
def test_a_calibrated_lens_images_the_whole_picture(lens: str) -> None:
    """Four views with dots in the middle of the picture only."""
    camera = true_camera("fisheye-kb4" if lens == "fisheye-kb4" else "mild")
    target, random = bench_target(), np.random.default_rng(1)
    q = []
    for number in range(4):
        turn = 0.5 * np.pi * number
        axis = np.array([np.cos(turn), np.sin(turn), 0.2 * random.normal()])
        T = np.eye(4)
        T[:3, :3] = np.diag([1.0, -1.0, -1.0]) @ cv2.Rodrigues(0.6 * axis)[0]
        distance = 3.0 * np.ptp(target.points()[:, 0])
        T[:3, 3] = [*random.uniform(-0.04, 0.04, 2) * distance, distance]
        T[:3, 3] -= T[:3, :3] @ target.points().mean(axis=0)
        q.append(camera.project(transform(T, target.points())).q)
    noisy = [one + random.normal(0.0, NOISE_PX, one.shape) for one in q]
    dots = dots_at(noisy, [np.isfinite(one[:, 0]) for one in q], target, SIZE, NOISE_PX)
    found = calibrate_handheld(dots, target, lens, HandheldSettings(eccentricity_rounds=0))
    (name,) = found.rig.cameras
    assert found.rig.camera(name).share_without_rays == 0.0
    assert np.abs(found.rig.camera(name).dist).max() < 2.0
    assert found.fits[name].open_lens  # told: nothing but an assumption holds it


def test_the_narrow_prior_is_taken_only_where_it_explains_as_well() -> None:
    folded, whole = (
        Camera(K, "brown5", np.array([k1, 0.0, 0.0, 0.0, 0.0]), np.eye(4), SIZE) for k1 in (-1.5, -0.1)
    )
    assert folded.share_without_rays > 0.0
    assert narrow_is_better([folded], [whole], 1.01)
    assert not narrow_is_better([folded], [whole], 1.5)
    assert not narrow_is_better([whole], [folded], 1.0)
    assert not narrow_is_better([folded], [folded], 1.0)
    assert narrow_is_better([whole], [whole], 1.0)


def test_a_lens_is_open_where_it_folds_or_its_border_is_not_determined() -> None:
    whole = true_camera("brown5")
    sure = np.diag([1e-6] * 5)
    assert not FoundLens(whole, sure).is_open
    assert FoundLens(whole, sure * np.nan).is_open
    assert FoundLens(whole, np.diag([1e-6, 1e-6, 1e-6, 1e-6, 4.0])).is_open  # k3 to 2
    folded = Camera(K, "brown5", np.array([-1.5, 0.0, 0.0, 0.0, 0.0]), np.eye(4), SIZE)
    assert FoundLens(folded, sure).is_open
    assert not FoundLens(Camera(K, "pinhole", np.zeros(5), np.eye(4), SIZE), np.zeros((0, 0))).is_open


def test_a_round_picture_is_no_reason_to_hold_a_lens() -> None:
    """The corners of a fisheye's picture are beyond its field, with any prior."""
    near = np.array([[300.0, 0.0, 640.0], [0.0, 300.0, 480.0], [0.0, 0.0, 1.0]])
    dist = np.array([-0.03, 0.005, -0.002, -0.0005, 0.0])
    camera = Camera(near, "fisheye-kb4", dist, np.eye(4), SIZE)
    share = camera.share_without_rays
    assert 0.0 < share < 0.5
    random = np.random.default_rng(5)
    off, around = random.uniform([0.0, 0.0], [1.5, 2 * np.pi], (400, 2)).T
    v = np.column_stack([np.sin(off) * np.cos(around), np.sin(off) * np.sin(around), np.cos(off)])
    p = v * random.uniform(800.0, 1500.0, (400, 1))
    q = camera.project(p).q + random.normal(0.0, NOISE_PX, (400, 2))
    found = resect("bundle", q, p, camera_of_lens("fisheye-kb4", SIZE, None))
    assert found.camera.share_without_rays == pytest.approx(share, abs=0.02)
    sigma = np.sqrt(np.diagonal(found.covariance))[-4:]
    assert (np.abs(found.camera.dist[:4] - camera.dist[:4]) < 4.0 * sigma).all()


def test_weights_are_effects_over_the_pictures_width() -> None:
    camera = true_camera("rational8")
    wide = coefficient_weights(camera, np.full(8, 3.0), PriorWidth.WIDE)
    np.testing.assert_allclose(wide, (3.0 / (SIZE[0] * np.array([1.0] * 5 + [0.01] * 3))) ** 2)
    narrow = coefficient_weights(camera, np.zeros(8), PriorWidth.NARROW)
    r = np.hypot(643.0 / 1200.0, 483.0 / 1201.0)  # of the corner that is farthest from the principal point
    along = r**3 * max(1200.0 * 643.0 / 1200.0, 1201.0 * 483.0 / 1201.0) / r
    np.testing.assert_allclose(narrow[0], (along / (0.05 * SIZE[0])) ** 2, rtol=1e-3)
    np.testing.assert_allclose(narrow[5] / narrow[0], 25.0, rtol=1e-9)  # k4 does what k1 does
    fisheye = coefficient_weights(true_camera("fisheye-kb4"), np.full(4, 3.0), PriorWidth.WIDE)
    np.testing.assert_allclose(fisheye, (3.0 / SIZE[0]) ** 2)
