"""The point spread before the pixels, against edges whose pictures are known in closed form."""

import numpy as np
import pytest
from blurred_edge import mean_in_squares
from scipy.ndimage import gaussian_filter
from scipy.stats import chi2

from labcal.render import bands
from labcal.render.point_spread import behind_lens, cells, finer, gathered, gathered_variance, reach

HEIGHT, WIDTH = 60, 160
SLOPE = 1.0 / 20.0
NORMAL = np.array([-SLOPE, 1.0]) / np.hypot(SLOPE, 1.0)
MIDDLE = np.array([80.3, 30.2])


def edge(side: int, blur_px: float) -> np.ndarray:
    """Return the exact picture of the edge in cells, `side` along a side of a pixel."""
    y, x = ((np.arange(side * n) + 0.5) / side - 0.5 for n in (HEIGHT, WIDTH))
    distance = (x - MIDDLE[0]) * NORMAL[0] + (y - MIDDLE[1])[:, None] * NORMAL[1]
    return mean_in_squares(distance, NORMAL / side, blur_px)


def seen_edge(blur_px: float, side: int) -> np.ndarray:
    return gathered(cells(edge(side, 0.0), side), blur_px)


@pytest.mark.parametrize(
    ("blur_px", "limit"), [(0.4, 3e-3), (0.6, 1.5e-3), (0.8, 1e-3), (1.5, 1e-3), (6.0, 1e-3)]
)
def test_an_edge_along_the_rows_has_no_staircase(blur_px: float, limit: float) -> None:
    true = edge(1, blur_px)
    inner = (slice(26, -26), slice(30, -30)) if blur_px > 1.5 else (slice(12, -12), slice(20, -20))
    off = (seen_edge(blur_px, finer(blur_px, 64)) - true)[inner]
    assert np.abs(off).max() < limit
    if blur_px < 1.5:  # pixels that are blurred themselves have one
        assert np.abs(seen_edge(blur_px, 1) - true)[inner].max() > 10.0 * limit


def test_pixels_of_few_rays_have_fewer_cells() -> None:
    assert [finer(0.8, rays) for rays in (1, 16, 63, 64, 256)] == [2, 2, 2, 4, 4]
    assert [finer(blur, 64) for blur in (0.1, 1.49, 1.5, 5.9, 6.0)] == [4, 4, 2, 2, 1]


@pytest.mark.parametrize("side", [1, 2, 4])
def test_the_point_spread_is_a_gauss_function(side: int) -> None:
    light = np.zeros((200 * side, 41 * side), np.float32)
    light[60 * side : 70 * side, 19 * side : 26 * side] = 1.0
    blurred = gaussian_filter(light.astype(np.float64), 1.3 * side, mode="nearest", truncate=6.0)
    expected = blurred.reshape(200, side, 41, side).mean(axis=(1, 3))
    np.testing.assert_allclose(gathered(cells(light, side), 1.3), expected, atol=1e-4)


def test_a_lens_that_holds_back_light_blurs_what_it_lets_pass() -> None:
    film = np.ones((2, HEIGHT, WIDTH, 2), dtype=np.float32)
    share = np.repeat(np.arange(WIDTH) > 80, HEIGHT).reshape(WIDTH, HEIGHT).T.astype(np.float32)
    seen, halo = behind_lens(film, share, 1.4), reach(1.4)
    assert seen.shape == (HEIGHT - 2 * halo, WIDTH - 2 * halo)
    distance = np.arange(WIDTH)[halo:-halo] - 80.5
    true = mean_in_squares(distance, np.array([1.0, 1e-3]), 1.4)
    np.testing.assert_allclose(seen, np.broadcast_to(true, seen.shape), atol=4e-3)
    np.testing.assert_array_equal(behind_lens(film, share, 0.0), share)


def test_light_without_blur_is_the_mean_of_its_cells() -> None:
    light = np.arange(24.0).reshape(4, 6)
    assert gathered(cells(light, 2), 0.0).tolist() == [[3.5, 5.5, 7.5], [15.5, 17.5, 19.5]]


@pytest.mark.parametrize("blur_px", [0.0, 0.8, 20.0])
@pytest.mark.parametrize("channels", [(), (3,)])
def test_bands_leave_no_seams(
    blur_px: float, channels: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    film = np.random.default_rng(0).random((2, 150, 40, 2, *channels), dtype=np.float32)
    banded = gathered(film, blur_px)
    monkeypatch.setattr(bands, "ROWS", 1000)
    np.testing.assert_array_equal(banded, gathered(film, blur_px))


def test_independent_noise_of_cells_has_the_variance_that_is_stated() -> None:
    random = np.random.default_rng(1)
    variance = np.zeros((4, 9, 9, 4), dtype=np.float32)
    variance[:, 4, 4] = random.uniform(0.5, 2.0, (4, 4))
    draws = 2000
    seen = np.stack(
        [
            gathered(np.sqrt(variance) * random.standard_normal(variance.shape, dtype=np.float32), 0.8)
            for _ in range(draws)
        ]
    )
    stated = gathered_variance(variance, 0.8)
    for place in ((4, 4), (4, 5), (3, 3)):
        ratio = (seen[:, *place].astype(np.float64) ** 2).sum() / stated[place]
        assert chi2.ppf(1e-4, draws) < ratio < chi2.ppf(1.0 - 1e-4, draws)
