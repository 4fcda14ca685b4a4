"""Light, noise and stored values of a picture, on pictures whose noise is known."""

import numpy as np
import pytest

from labcal.guide.twin.light import fitted_light
from labcal.guide.twin.noise import PictureNoise, measured_noise
from labcal.guide.twin.stored import StoredValues
from labcal.shoot.tone_curve import ToneCurve

SHAPE = (240, 320)
SIGMAS = 4.0


@pytest.fixture
def share() -> np.ndarray:
    """Paper with four large squares of ink."""
    made = np.ones(SHAPE, dtype=np.float32)
    for top in (20, 130):
        for left in (30, 180):
            made[top : top + 80, left : left + 100] = 0.0
    return made


def _uneven(share: np.ndarray) -> np.ndarray:
    rows, cols = np.mgrid[: SHAPE[0], : SHAPE[1]]
    paper = 180.0 - 0.1 * cols + 5e-4 * rows**2
    return np.asarray((share * paper + (1.0 - share) * (12.0 + 0.01 * rows)).astype(np.float32))


@pytest.mark.parametrize("correlation", [0.0, 0.3])
def test_photon_transfer_finds_the_noise(share: np.ndarray, correlation: float) -> None:
    random = np.random.default_rng(5)
    clean, true = _uneven(share), PictureNoise(2.0, 0.05, correlation, correlation, 0)
    found = measured_noise(true.drawn(clean, random), share == 1.0, share == 0.0)
    assert found is not None
    for level in (12.0, 170.0):
        light = np.array([[level]], dtype=np.float32)
        ratio = float(found.variance(light)[0, 0] / true.variance(light)[0, 0])
        # Of a median over blocks of 49 correlated pixels; 0.64 is the efficiency of a median.
        chance = np.sqrt(2.0 / (0.64 * 46.0 * 0.25 * found.blocks)) * (1.0 + 2.0 * correlation)
        assert abs(ratio - 1.0) < SIGMAS * chance
    assert abs(found.along - correlation) < 0.03
    assert abs(found.down - correlation) < 0.03


def test_light_is_fitted_to_noise_level(share: np.ndarray) -> None:
    random = np.random.default_rng(6)
    clean = _uneven(share)
    photo = (clean + random.standard_normal(SHAPE)).astype(np.float32)
    light = fitted_light(photo, share, np.ones(SHAPE, dtype=bool), random)
    assert light is not None
    off = light.image(share) - clean
    # 12000 pixels and at most 45 coefficients for each of the two.
    assert float((off**2).mean()) < SIGMAS * 45.0 / 12_000.0


def test_dust_does_not_move_the_light(share: np.ndarray) -> None:
    random = np.random.default_rng(7)
    clean = _uneven(share)
    photo = (clean + random.standard_normal(SHAPE)).astype(np.float32)
    photo[random.random(SHAPE) < 0.01] += 100.0
    light = fitted_light(photo, share, np.ones(SHAPE, dtype=bool), random)
    assert light is not None
    assert float(np.abs(light.image(share) - clean).mean()) < 0.2


@pytest.mark.parametrize("curve", [ToneCurve.LINEAR, ToneCurve.SRGB])
@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
def test_stored_values_make_a_round_trip(curve: ToneCurve, kind: type) -> None:
    picture = np.arange(256, dtype=kind).reshape(16, 16)
    stored = StoredValues.of(picture, curve)
    np.testing.assert_array_equal(stored.picture(stored.channels(picture)), picture)


def test_rounding_has_the_variance_of_a_step() -> None:
    light = np.full((2, 2), 100.0, dtype=np.float32)
    stored = StoredValues("uint8", ToneCurve.LINEAR)
    np.testing.assert_allclose(stored.step_variance(light), 1.0 / 12.0, rtol=1e-6)


def test_ink_so_dark_that_rounding_leaves_two_values_has_its_mean() -> None:
    random = np.random.default_rng(0)
    light = np.rint(3.8 + 0.15 * random.standard_normal((60, 60))).astype(np.float32)  # 4, now and then 3
    light[:, 30:] = np.rint(150.0 + random.standard_normal((60, 30)))
    share = np.repeat(np.repeat(np.float32([[0.0, 1.0]]), 30, axis=1), 60, axis=0)
    found = fitted_light(light, share, np.ones((60, 60), dtype=bool), random)
    assert found is not None
    assert abs(float(found.ink.over((60, 60))[:, :30].mean()) - float(light[:, :30].mean())) < 0.05
