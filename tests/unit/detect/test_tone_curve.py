"""The curve from light to grey values that fits of a print know."""

import numpy as np
import pytest

from labcal.detect.corners.tone_curve import by_tone, tone_terms, toned

PATTERN = np.linspace(-1.0, 1.0, 201)


def _curve(tone: float) -> np.ndarray:
    terms = tone_terms(tone)
    return np.array([toned(X, terms) for X in PATTERN.tolist()])


@pytest.mark.parametrize("tone", [-0.3, -0.02, 0.0, 5e-4, 0.1, 0.38])
def test_ends_stay_and_slopes_are_those_of_the_curve(tone: float) -> None:
    T, slope = _curve(tone).T
    assert T[[0, 100, -1]] == pytest.approx([-1.0, tone, 1.0], abs=1e-9)
    assert np.abs(np.gradient(T, PATTERN)[2:-2] - slope[2:-2]).max() < 0.02 * slope.max()
    assert (np.diff(T) > 0.0).all()
    step = 1e-5
    change = (_curve(tone + step)[:, 0] - _curve(tone - step)[:, 0]) / (2.0 * step)
    assert by_tone(PATTERN, tone) == pytest.approx(change, abs=2e-3)


def test_slight_curves_go_on_into_stronger_ones() -> None:
    below, above = _curve(0.999e-3)[:, 0], _curve(1.001e-3)[:, 0]
    assert np.abs(above - below).max() < 5e-6


@pytest.mark.parametrize("ink", [0.02, 0.06, 0.2])
@pytest.mark.parametrize("power", [1 / 2.2, 1 / 1.5, None])
def test_grey_values_of_cameras_are_met(power: float | None, ink: float) -> None:
    light = 0.9 * (ink + (1.0 - ink) * 0.5 * (PATTERN + 1.0))
    grey = 1.055 * light ** (1 / 2.4) - 0.055 if power is None else light**power

    def left(tone: float) -> float:
        design = np.stack([np.ones_like(PATTERN), _curve(tone)[:, 0]], axis=1)
        return float(np.std(grey - design @ np.linalg.lstsq(design, grey, rcond=None)[0]))

    half = 0.5 * float(grey[-1] - grey[0])
    assert min(map(left, np.linspace(0.02, 0.4, 77).tolist())) < 0.012 * half
