import numpy as np
import pytest

from labcal.render.samples import Samples
from labcal.render.variant import MONO, renderer


def drawn(count: int, pixels: int, purpose: int = 0, seed: int = 3) -> np.ndarray:
    """Return points (pixels, count, 2)."""
    with renderer(MONO) as mi:
        lane = np.arange(count * pixels, dtype=np.uint32)
        pixel, index = mi.UInt32(lane // count), mi.UInt32(lane % count)
        square = Samples(mi, pixel, index, mi.UInt32(seed), count).square(purpose)
        return np.array(square, np.float64).T.reshape(pixels, count, 2)


@pytest.mark.parametrize(("across", "down"), [(16, 16), (256, 1), (4, 64)])
def test_every_elementary_interval_of_a_pixel_has_one_sample(across: int, down: int) -> None:
    points = drawn(256, 20)
    cell = np.floor(points * [across, down]).astype(int)
    counts = np.zeros((20, across, down), dtype=int)
    np.add.at(counts, (np.arange(20)[:, None], cell[..., 0], cell[..., 1]), 1)
    assert (counts == 1).all()


def test_samples_are_uniform_and_purposes_and_pixels_independent() -> None:
    first, second = drawn(4, 20_000), drawn(4, 20_000, purpose=1)
    for points in (first, second):
        for axis in (0, 1):  # one sample a pixel, since those of one pixel keep out of each other's way
            histogram = np.histogram(points[:, 0, axis], bins=50, range=(0, 1))[0]
            expected = len(points) / 50
            assert ((histogram - expected) ** 2 / expected).sum() < 87  # chi-square, 49 degrees, 0.1%
    pairs = np.concatenate([first[:, 0], second[:, 0]], axis=1)
    correlation = np.corrcoef(pairs.T)[np.triu_indices(4, 1)]
    assert np.abs(correlation).max() < 3.5 / np.sqrt(20_000)
    assert not np.array_equal(first, drawn(4, 20_000, seed=4))


def test_samples_in_one_half_of_a_pixel_choose_no_half_of_a_lamp() -> None:
    pixel, lamp = drawn(64, 2000), drawn(64, 2000, purpose=1)
    for of_pixel in (0, 1):
        for of_lamp in (0, 1):
            left = pixel[..., of_pixel] < 0.5
            both = (left & (lamp[..., of_lamp] < 0.5)).sum(axis=1)
            random = 32 * 0.5 * 0.5 * 32 / 63  # variance of 32 drawn of 64 at random, of which 32 are wanted
            assert both.var() < 3.0 * random  # 256 where the one half takes the other
            assert abs(both.mean() - 16) < 4.0 * np.sqrt(both.var() / 2000)
