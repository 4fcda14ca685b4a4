"""Stated covariances of drawn dots through mosaic, demosaicing and JPEG (OpenCV's), and the parts of it."""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
import pytest
from scipy.special import ndtr

from labcal.detect.edge_fit import EdgeFits, fit_edges
from labcal.detect.edges.outline_noise import chosen_harmonics, long_wave_ratio, own_powers
from labcal.detect.grey import grey_picture
from labcal.detect.outlines.outlines import Outlines
from labcal.detect.stage_settings.edge import EdgeSettings

SETTINGS = EdgeSettings()
FINE = 4
USUAL, STRONG = (8000.0, 5.0), (2000.0, 60.0)
"""Full well and read noise, electrons."""


@dataclass(frozen=True)
class Sheet:
    """Blurred discs on white, at random places: light as a share of full scale, centres (px)."""

    light: np.ndarray
    centre: np.ndarray
    radius: float

    def fit(self, picture: np.ndarray) -> EdgeFits:
        n = len(self.centre)
        start = self.centre + np.random.default_rng(1).uniform(-0.3, 0.3, (n, 2))
        spots = Outlines(start, np.tile(np.eye(2) * self.radius**2, (n, 1, 1)), np.zeros(n), np.ones(n))
        return fit_edges(grey_picture(picture), spots, np.zeros(n), 1.9)


def sheet(radius: float, seed: int, ragged_px: float = 0.0, blur: float = 0.6, cols: int = 14) -> Sheet:
    """Draw discs in ten rows; the pitch is no multiple of the sides of mosaics and blocks."""
    rng = np.random.default_rng(seed)
    side = int(4 * radius) + 3
    light = np.empty((10 * side, cols * side))
    centres = []
    k = (np.arange(side * FINE) + 0.5) / FINE - 0.5
    for row in range(10):
        for col in range(cols):
            x, y = 0.5 * (side - 1) + rng.uniform(-2, 2, 2)
            X, Y = np.meshgrid(k - x, k - y)
            edge = np.full_like(X, radius)
            for harmonic in range(4, 16 if ragged_px else 4):
                turned = np.arctan2(Y, X) * harmonic + rng.uniform(0, 2 * np.pi)
                edge += ragged_px * np.sqrt(2) * np.cos(turned)
            covered = ndtr((edge - np.hypot(X, Y)) / blur)
            place = np.s_[row * side : (row + 1) * side, col * side : (col + 1) * side]
            light[place] = 0.7 - 0.65 * covered.reshape(side, FINE, side, FINE).mean((1, 3))
            centres.append((col * side + x, row * side + y))
    slope = 1.0 - 0.3 * np.mgrid[: light.shape[0], : light.shape[1]][1] / light.shape[1]
    return Sheet(light * slope, np.array(centres), radius)


def noisy(light: np.ndarray, full_well: float, dark: float, seed: int) -> np.ndarray:
    """Return light after photon noise and read noise, electrons."""
    rng = np.random.default_rng(seed)
    electrons = rng.poisson(full_well * light) + rng.normal(0, dark, light.shape)
    return np.clip(electrons / full_well, 0, 1)


def delivered(linear: np.ndarray) -> np.ndarray:
    """Return 8 bits after a curve near sRGB's."""
    return np.rint(255 * np.clip(linear, 0, 1) ** (1 / 2.2)).astype(np.uint8)


def demosaiced(reading: np.ndarray, code: int) -> np.ndarray:
    return delivered(cv2.demosaicing(np.rint(65535 * reading).astype(np.uint16), code) / 65535.0)


def through_jpeg(picture: np.ndarray, quality: int) -> np.ndarray:
    data = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
    return np.asarray(cv2.imdecode(data, cv2.IMREAD_UNCHANGED))


def few_rays(light: np.ndarray, seed: int) -> np.ndarray:
    """Return a rendered picture of 16 rays a pixel: most noise is on the edges."""
    rng, lit = np.random.default_rng(seed), light / light.max(axis=0)
    rays = rng.binomial(16, (1.0 - lit) / np.ptp(lit)) / 16
    return np.rint(255 * (0.8 - 0.7 * rays + rng.normal(0, 0.01, rays.shape))).astype(np.uint8)


BILINEAR, EDGE_AWARE = cv2.COLOR_BayerRGGB2RGB, cv2.COLOR_BayerRGGB2RGB_EA
KINDS: dict[str, Callable[[np.ndarray, int], np.ndarray]] = {
    "grey": lambda light, seed: np.rint(255 * noisy(light, *USUAL, seed)).astype(np.uint8),
    "grey, strong noise": lambda light, seed: delivered(noisy(light, *STRONG, seed)),
    "grey, JPEG 80": lambda light, seed: through_jpeg(delivered(noisy(light, *USUAL, seed)), 80),
    "bilinear": lambda light, seed: demosaiced(noisy(light, *USUAL, seed), BILINEAR),
    "edge-aware": lambda light, seed: demosaiced(noisy(light, *USUAL, seed), EDGE_AWARE),
    "bilinear, JPEG 90": lambda light, seed: through_jpeg(
        demosaiced(noisy(light, *USUAL, seed), BILINEAR), 90
    ),
    "bilinear, JPEG 75": lambda light, seed: through_jpeg(
        demosaiced(noisy(light, *USUAL, seed), BILINEAR), 75
    ),
    "bilinear, strong noise": lambda light, seed: demosaiced(noisy(light, *STRONG, seed), BILINEAR),
    "few rays": few_rays,
}


@pytest.fixture(scope="module")
def sheets() -> list[Sheet]:
    return [sheet(6.0, 21), sheet(11.0, 22)]


@pytest.mark.parametrize("kind", KINDS)
def test_errors_are_as_large_as_stated(kind: str, sheets: list[Sheet]) -> None:
    # By the noise of the flat parts alone seven of the nine means are 0.1 to 0.6, or 1.5 to 3.1.
    squares = []
    for number, drawn in enumerate(sheets):
        found = drawn.fit(KINDS[kind](drawn.light, number))
        assert found.ok.all()
        errors = found.centre - drawn.centre
        squares.append(np.einsum("ni,nij,nj->n", errors, np.linalg.inv(found.covariance), errors))
    total = np.concatenate(squares)
    # 560 normal numbers, and two factors that are themselves known to a tenth.
    assert 0.7 < total.mean() / 2 < 1.35
    assert 0.9 < (total < 5.991).mean() < 0.99


@pytest.mark.parametrize(("radius", "cols"), [(7.0, 14), (20.0, 6)])
def test_noise_at_upright_edges_is_stated_in_x(radius: float, cols: int) -> None:
    drawn, off = sheet(radius, 23, cols=cols), []
    deviation = 2.0 + 66.0 * np.abs(np.gradient(drawn.light, axis=1))  # as few rays leave it, but in x alone
    for seed in range(4):
        noise = deviation * np.random.default_rng(seed).standard_normal(drawn.light.shape)
        found = drawn.fit(np.rint(np.clip(220 * drawn.light + 20 + noise, 0, 255)).astype(np.uint8))
        sigma = np.sqrt(np.diagonal(found.covariance, axis1=1, axis2=2))
        off.append((found.centre - drawn.centre) / sigma)
    squares = (np.concatenate(off) ** 2).mean(axis=0)
    # Of all dots, in x and y: z of 4. With one factor for both axes, x has twice the square of y.
    assert abs(np.log(squares[0] / squares[1])) < 4.0 * np.sqrt(4.0 / (40 * cols))


def test_a_ragged_print_is_no_noise_of_large_dots() -> None:
    drawn = sheet(20.0, 5, ragged_px=0.05, blur=1.2, cols=4)
    spread = np.std([drawn.fit(KINDS["grey"](drawn.light, seed)).centre for seed in range(4)], axis=0, ddof=1)
    stated = drawn.fit(KINDS["grey"](drawn.light, 9)).covariance
    ratio = np.sqrt(np.trace(stated, axis1=1, axis2=2).mean() / 2 / (spread**2).mean())
    assert 0.8 < ratio < 2.0


@pytest.mark.parametrize("curvature", [-20.0, 0.0, 15.0])
def test_the_level_at_long_waves_is_estimated_with_its_error(curvature: float) -> None:
    rng, waves = np.random.default_rng(3), np.array([16.0, 11.0, 8.0, 6.0, 5.0])
    off = []
    for _ in range(300):
        weight = rng.uniform(0.8, 1.0, (60, 5))
        power = 0.7 * np.exp(curvature / waves**2) * weight * rng.chisquare(2, (60, 5)) / 2
        ratio, error = long_wave_ratio(np.stack([power, weight], axis=2), waves, SETTINGS)
        off.append(np.log(ratio / 0.7) / error)
    assert abs(np.mean(off)) < 0.35
    assert 0.85 < np.std(off) < 1.15


def test_waves_of_the_print_do_not_count() -> None:
    rng, waves = np.random.default_rng(4), np.array([24.0, 16.0, 11.0, 8.0, 6.0, 4.6])
    weight = np.ones((80, 6))
    white = weight * rng.chisquare(2, (80, 6)) / 2
    print_ = 60.0 * np.exp(-((2 * np.pi * 2.0 / waves) ** 2)) * rng.chisquare(2, (80, 6)) / 2
    ratio, _ = long_wave_ratio(np.stack([white + print_, weight], axis=2), waves, SETTINGS)
    mean = (white + print_).sum() / weight.sum()
    assert mean > 8.0
    assert ratio < 6.0


def test_dots_that_fit_badly_do_not_count() -> None:
    rng, waves = np.random.default_rng(6), np.array([12.0, 8.0, 5.0])
    power = rng.chisquare(2, (50, 3)) / 2
    power[:4] *= 1e4
    ratio, error = long_wave_ratio(np.stack([power, np.ones((50, 3))], axis=2), waves, SETTINGS)
    assert abs(np.log(ratio)) < 3 * error


def test_what_all_dots_share_is_taken_out() -> None:
    rng = np.random.default_rng(8)
    step = rng.uniform(50.0, 200.0, 400)
    sums = np.ones((400, 4, 3))
    sums[..., :2] = rng.normal(0, np.sqrt(0.5), (400, 4, 2))
    shifted = sums.copy()
    shifted[..., :2] += 0.1 * step[:, None, None]
    np.testing.assert_allclose(own_powers(shifted, step), own_powers(sums, step), atol=1e-8)
    assert abs(own_powers(sums, step)[..., 0].mean() - 1.0) < 4 / np.sqrt(1600)


@pytest.mark.parametrize("radius", [1.5, 3.0, 5.0, 8.0, 20.0, 47.0, 400.0])
def test_harmonics_are_odd_few_and_of_waves_of_some_pixels(radius: float) -> None:
    harmonics = chosen_harmonics(radius, SETTINGS)
    number = harmonics.first + harmonics.stride * np.arange(harmonics.terms)
    assert (number % 2 == 1).all()
    assert number.min() >= 3
    assert 1 <= harmonics.terms <= SETTINGS.noise_harmonics
    if radius > 3.0:
        waves = 2 * np.pi * radius / number
        assert waves.min() >= SETTINGS.noise_short_px
        assert waves.max() < 1.4 * SETTINGS.noise_long_px


def test_one_dot_has_the_noise_beside_it() -> None:
    drawn = sheet(6.0, 30, cols=1)
    alone = Sheet(drawn.light[:27, :27], drawn.centre[:1], 6.0)
    found = alone.fit(KINDS["grey"](alone.light, 1))
    assert found.ok.all()
    assert 0.3 < found.noise_factor < 3.0
