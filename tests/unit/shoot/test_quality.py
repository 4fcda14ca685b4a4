"""Exposure and sharpness against what a blurred disc must give."""

import numpy as np
import pytest
from scipy.special import erf, ndtr

from labcal.shoot.quality import edge_directions, picture_quality, saturated


def discs(blur_px: float, low: float = 50.0, high: float = 200.0) -> np.ndarray:
    """Return dark discs of 15 px radius on a light ground, their edges blurred, with noise of 2 levels."""
    y, x = np.mgrid[:300, :400].astype(np.float64)
    dark = np.zeros((300, 400))
    for centre_x in range(40, 400, 60):
        for centre_y in range(40, 300, 60):
            distance = np.hypot(x - centre_x - 0.3, y - centre_y + 0.2) - 15
            dark = np.maximum(dark, ndtr(-distance / blur_px))
    noise = np.random.default_rng(0).normal(0, 2, dark.shape)
    return np.clip(high - (high - low) * dark + noise, 0, 255).astype(np.uint8)


@pytest.mark.parametrize("blur_px", [0.7, 1.0, 1.5, 2.0, 3.0])
def test_sharpness_tells_the_blur(blur_px: float) -> None:
    quality = picture_quality(discs(blur_px))
    assert quality.sharpness == pytest.approx(erf(1 / (blur_px * np.sqrt(2))) / 2, rel=0.1)
    assert quality.edge_width_px == pytest.approx(1 / quality.sharpness)


def test_sharpness_depends_on_neither_light_nor_kind() -> None:
    bright, dim = discs(1.5), discs(1.5, 40.0, 90.0)
    colour = np.repeat(bright[..., None], 3, axis=-1)
    expected = picture_quality(bright).sharpness
    assert picture_quality(dim).sharpness == pytest.approx(expected, rel=0.1)
    for same in (colour, bright.astype(np.uint16) * 257, bright.astype(np.float32) / 255):
        assert picture_quality(same).sharpness == pytest.approx(expected, rel=1e-4)
        assert picture_quality(same).median_level == pytest.approx(picture_quality(bright).median_level)


def test_without_edges_there_is_no_sharpness() -> None:
    noise = np.random.default_rng(0).normal(100, 5, (200, 300)).astype(np.uint8)
    for picture in (noise, np.full((60, 80), 9, np.uint8), np.zeros((1, 1), np.uint8)):
        assert np.isnan(picture_quality(picture).sharpness)


def test_exposure_counts_pixels_with_a_channel_at_full_scale() -> None:
    picture = np.full((10, 20, 3), 51, np.uint8)
    picture[:2, :5, 0] = 255
    picture[5, 5] = 254
    quality = picture_quality(picture)
    assert quality.saturated_share == pytest.approx(10 / 200)
    assert quality.median_level == pytest.approx(0.2)
    assert saturated(picture).sum() == 10
    assert picture_quality(np.full((4, 5), 65535, np.uint16)).saturated_share == 1.0
    assert picture_quality(np.full((4, 5), 255, np.uint16)).saturated_share == 0.0


def squares(turn_deg: float, blur_px: float) -> np.ndarray:
    """Return a chessboard, turned, with noise of 2 levels."""
    y, x = np.mgrid[:400, :500].astype(np.float64)
    turn = np.radians(turn_deg)
    u, v = (x * np.cos(turn) + y * np.sin(turn)) / 40.0, (y * np.cos(turn) - x * np.sin(turn)) / 40.0
    wave = [np.sin(np.pi * along) / np.pi * 40.0 for along in (u, v)]
    black = 2.0 * (ndtr(wave[0] / blur_px) - 0.5) * (ndtr(wave[1] / blur_px) - 0.5) + 0.5
    noise = np.random.default_rng(0).normal(0, 2, black.shape)
    return np.clip(200.0 - 150.0 * black + noise, 0, 255).astype(np.uint8)


@pytest.mark.parametrize("turn_deg", [0.0, 8.0, 30.0, 45.0])
def test_directions_without_edges_of_a_chessboard_have_no_width(turn_deg: float) -> None:
    widths = edge_directions(squares(turn_deg, 1.0))
    known = np.isfinite(widths)
    assert known.sum() >= 2
    assert widths[known].max() < 1.5 * picture_quality(squares(turn_deg, 1.0)).edge_width_px
