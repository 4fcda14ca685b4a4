"""Trends over the dots of a picture: what is usual in a light, whatever some of the dots do."""

import numpy as np

from labcal.detect.checks.usual_light import misfits, paleness
from labcal.detect.stage_settings.quality import QualitySettings

SETTINGS = QualitySettings()

LIGHT = np.linspace(40.0, 200.0, 60)
DARK = 0.06 * LIGHT + 3.0


def test_noise_that_grows_with_light_is_usual_and_more_is_not() -> None:
    rng = np.random.default_rng(0)
    variance = (6.0 + 0.05 * LIGHT) * rng.chisquare(300, 60) / 300
    odd = np.arange(0, 60, 5)
    variance[odd] *= 6.0
    found = misfits(DARK, LIGHT, variance, SETTINGS)
    assert found[odd].min() > 2.0
    assert np.abs(np.delete(found, odd) - 1.0).max() < 0.3


def test_a_picture_without_noise_has_no_misfit() -> None:
    left = np.abs(np.random.default_rng(1).normal(0, 1e-3, 60))
    assert misfits(DARK, LIGHT, left, SETTINGS).max() < 0.1
    assert (misfits(DARK, LIGHT, np.zeros(60), SETTINGS) == 0.0).all()


def test_a_dot_that_is_paler_than_its_light_makes_it_is_told_by_the_share_of_its_step() -> None:
    dot = DARK.copy()
    dot[[7, 40]] += 0.4 * (LIGHT - DARK)[[7, 40]]
    found = paleness(LIGHT, dot, SETTINGS)
    np.testing.assert_allclose(found[[7, 40]], 0.4, atol=0.02)
    assert np.abs(np.delete(found, [7, 40])).max() < 0.02
    assert (paleness(DARK, LIGHT, SETTINGS) == 0.0).all()  # white dots


def test_few_dots_and_missing_ones() -> None:
    light, variance = np.array([100.0, np.nan, 120.0]), np.array([4.0, np.nan, 4.0])
    np.testing.assert_allclose(misfits(0.1 * light, light, variance, SETTINGS), [1.0, np.nan, 1.0])
    nothing = np.full(2, np.nan)
    assert np.isnan(misfits(nothing, nothing, nothing, SETTINGS)).all()
    assert np.isnan(paleness(nothing, nothing, SETTINGS)).all()
