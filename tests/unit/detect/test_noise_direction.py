"""Direction of the noise along outlines, from products of harmonics with neighbouring numbers."""

import numpy as np
import pytest

from labcal.detect.edges.harmonics import Harmonics
from labcal.detect.edges.noise_direction import neighbouring, noise_by_direction
from labcal.detect.stage_settings.edge import EdgeSettings

SETTINGS = EdgeSettings()
ODD = Harmonics(first=3, stride=2, terms=3)


def sums_along(outline: np.ndarray, harmonics: Harmonics) -> np.ndarray:
    """Return the sums by harmonic of noise along outlines, (n, k, 2)."""
    phi = 2.0 * np.pi * np.arange(outline.shape[1]) / outline.shape[1]
    number = harmonics.first + harmonics.stride * np.arange(harmonics.terms)
    waves = np.stack([np.cos(number[:, None] * phi), np.sin(number[:, None] * phi)], axis=2)
    return np.asarray(np.einsum("np,kpc->nkc", outline, waves) * np.sqrt(2.0 / outline.shape[1]))


def drawn(a: float, b: float, dots: int, seed: int) -> np.ndarray:
    """Return noise with the variance 1 + a cos 2 phi + b sin 2 phi along outlines of 48 points."""
    phi = 2.0 * np.pi * np.arange(48) / 48
    sigma = np.sqrt(1.0 + a * np.cos(2.0 * phi) + b * np.sin(2.0 * phi))
    return np.asarray(sigma * np.random.default_rng(seed).standard_normal((dots, 48)))


@pytest.mark.parametrize(("a", "b"), [(0.0, 0.0), (0.4, 0.0), (-0.3, 0.5)])
def test_the_covariance_of_a_shift_is_found(a: float, b: float) -> None:
    dots = 20_000
    outline = drawn(a, b, dots, 5)
    found = noise_by_direction(sums_along(outline, ODD), np.full((dots, 3), 2.0), ODD, SETTINGS)
    expected = np.array([[1.0 + a / 2, b / 2], [b / 2, 1.0 - a / 2]])
    # A sum of products of as many pairs as dots, terms and components: z of 4.
    np.testing.assert_allclose(found, expected, atol=4.0 / np.sqrt(2 * 2 * dots))
    # The covariance of the shift itself, which is the first harmonic.
    shift = sums_along(outline, Harmonics(1, 2, 1))[:, 0]
    np.testing.assert_allclose(shift.T @ shift / dots, expected, atol=4.0 * np.sqrt(2.0 / dots) * 1.3)


def test_few_dots_say_little() -> None:
    few = [
        noise_by_direction(sums_along(drawn(0.4, 0.0, 4, seed), ODD), np.full((4, 3), 2.0), ODD, SETTINGS)
        for seed in range(200)
    ]
    off = np.array(few)[:, 0, 0] - 1.0
    weight = 1.0 / (1.0 + 1.0 / (16 * 0.2**2))
    assert abs(off.mean() - 0.2 * weight) < 4.0 * off.std() / np.sqrt(200)
    assert all((np.linalg.eigvalsh(one) > 0.0).all() for one in few)


@pytest.mark.parametrize("harmonics", [Harmonics(3, 2, 1), Harmonics(5, 4, 3)])
def test_harmonics_without_neighbours_tell_no_direction(harmonics: Harmonics) -> None:
    sums = sums_along(drawn(0.8, 0.0, 100, 1), harmonics)
    expected = np.full((100, harmonics.terms), 2.0)
    np.testing.assert_array_equal(noise_by_direction(sums, expected, harmonics, SETTINGS), np.eye(2))


def test_neighbours_start_at_the_same_longest_wave() -> None:
    assert neighbouring(Harmonics(5, 4, 3)) == Harmonics(5, 2, 3)
    assert neighbouring(ODD) == ODD
