"""Noise of a picture, measured in small blocks."""

import numpy as np
import pytest

from labcal.guide.twin.noise import PictureNoise, measured_noise

SMALL = 5


@pytest.mark.parametrize("correlations", [(0.0, 0.0), (0.36, 0.36), (0.45, 0.1), (-0.2, 0.3)])
@pytest.mark.parametrize("side", [SMALL, 7])
def test_correlated_noise_is_measured_rightly(correlations: tuple[float, float], side: int) -> None:
    true = PictureNoise(4.0, 0.05, *correlations, 0)
    light = np.full((420, 420), 60.0, np.float32)
    light[:, 210:] = 200.0
    picture = true.drawn(light, np.random.default_rng(3))
    where, dark = np.ones(light.shape, bool), light < 100.0
    if side == SMALL:
        where[3::7] = False  # no block of 7 px is whole
    found = measured_noise(picture, where & ~dark, where & dark)
    assert found is not None
    assert abs(found.along - correlations[0]) < 0.03
    assert abs(found.down - correlations[1]) < 0.03
    at = np.array([[60.0, 200.0]], np.float32)
    assert np.abs(found.variance(at) / true.variance(at) - 1.0).max() < 0.04
