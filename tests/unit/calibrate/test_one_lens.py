"""Pictures of two lenses under one camera's name are told; those of one lens, on whatever print, are not."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from labcal.bench.hand_views import HandViews, poses_in_hand
from labcal.calibrate.calibrated import calibrated
from labcal.calibrate.handheld import HandheldSettings
from labcal.cameras.camera import Camera
from labcal.correspond.detections import Detections
from labcal.correspond.gathering import joined
from labcal.targets.catalogue import load_target

See = Callable[..., Detections]
TARGET = load_target("rings-10x8")
HELD = HandViews(views=9, tilt_deg=35.0, radius_px=14.0)
CENTRES = HandheldSettings(eccentricity_rounds=0)
NOISE_PX = 0.03


def camera(
    focal_px: float = 1500.0, middle: tuple[float, float] = (640.0, 470.0), k1: float = -0.2
) -> Camera:
    K = np.array([[focal_px, 0.0, middle[0]], [0.0, focal_px, middle[1]], [0.0, 0.0, 1.0]])
    return Camera(K, "brown-k1k2", np.array([k1, 0.08, 0.0, 0.0, 0.0]), np.eye(4), (1280, 960))


def taken(see: See, one: Camera, seed: int, name: str, uneven_mm: float = 0.0) -> Detections:
    """Return the noisy dots of one camera, of a print that is the same for all seeds."""
    random = np.random.default_rng(seed)
    poses = {f"{name}{number}": T for number, T in enumerate(poses_in_hand(one, TARGET, HELD, random))}
    exact = see({"camera": one}, TARGET, poses)
    printed = TARGET.points()
    printed[:, :2] += uneven_mm * np.random.default_rng(1).normal(size=(TARGET.count, 2))
    q = np.concatenate([one.project(printed @ T[:3, :3].T + T[:3, 3]).q for T in poses.values()])
    noise = NOISE_PX * random.normal(size=q.shape)
    covariance = np.tile(NOISE_PX**2 * np.eye(2), (len(exact), 1, 1))
    return replace(exact, position=q + noise, covariance=covariance)


@pytest.mark.parametrize(
    ("other", "uneven_mm"),
    [
        (camera(1480.0, (655.0, 460.0), -0.18), 0.0),
        (camera(middle=(640.0 + 12.0, 470.0 - 9.0)), 0.0),  # the same model, mounted a little otherwise
        (camera(1500.0 * 1.02), 0.0),  # refocused
        (camera(1480.0, (655.0, 460.0), -0.18), 0.05),  # an uneven print hides nothing
    ],
)
def test_two_lenses_are_told_with_their_views(see: See, other: Camera, uneven_mm: float) -> None:
    both = joined([taken(see, camera(), 1, "a", uneven_mm), taken(see, other, 2, "b", uneven_mm)])
    made = calibrated(both, TARGET, "brown-k1k2", CENTRES)
    found = made.found.fits["camera"].two_lenses
    assert found is not None
    first, second = found.groups
    wrong = sum(view[0] != "a" for view in first) + sum(view[0] != "b" for view in second)
    assert wrong <= 1
    (warning,) = [text for text in made.warnings if "not those of one lens" in text]
    assert warning.index("two cameras") < warning.index("refocused") < warning.index("lens model")
    assert first[0] in warning
    assert not any("uneven print" in text for text in made.warnings)


@pytest.mark.parametrize("uneven_mm", [0.0, 0.02, 0.05])
@pytest.mark.parametrize("lens", ["brown-k1k2", "brown5"])
def test_one_lens_is_accused_of_nothing(see: See, lens: str, uneven_mm: float) -> None:
    for seed in range(2):
        dots = taken(see, camera(), 10 + seed, "a", uneven_mm)
        assert calibrated(dots, TARGET, lens, CENTRES).found.fits["camera"].two_lenses is None


def test_few_views_are_not_split(see: See) -> None:
    dots = taken(see, camera(), 1, "a")
    few = dots.where(np.isin(dots.view, ["a5", "a7", "a8"]))
    assert calibrated(few, TARGET, "pinhole", CENTRES).found.fits["camera"].two_lenses is None


@pytest.mark.slow
def test_good_cameras_are_accused_in_no_more_than_one_of_a_hundred(see: See) -> None:
    accused = 0
    for seed in range(200):
        random = np.random.default_rng([3, seed])
        one = camera(random.uniform(1000.0, 3000.0), (640.0, 470.0), random.uniform(-0.3, 0.1))
        dots = taken(see, one, 1000 + seed, "a", random.choice([0.0, 0.01, 0.03]))
        kept = np.isin(
            dots.view, [f"a{number}" for number in random.permutation(9)[: random.integers(5, 10)]]
        )
        found = calibrated(dots.where(kept), TARGET, "brown5", CENTRES).found
        accused += found.fits["camera"].two_lenses is not None
    assert accused <= 2
