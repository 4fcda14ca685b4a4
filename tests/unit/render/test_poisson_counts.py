import numpy as np
import pytest
from scipy.stats import chi2, norm
from scipy.stats import poisson as poissons

from labcal.render.poisson_counts import FEW, _quantile, poisson
from labcal.rng import generator


@pytest.mark.parametrize("mean", [FEW, 300.0, 5000.0])
def test_the_counts_of_ranks_have_poissons_distribution(mean: float) -> None:
    w = np.linspace(-7.0, 7.0, 2_000_001)
    counts = _quantile(np.full_like(w, mean), w)
    assert (np.diff(counts) >= 0).all()
    k = np.arange(int(mean - 6 * np.sqrt(mean)), int(mean + 7 * np.sqrt(mean)))
    below = norm.cdf(w[np.searchsorted(counts, k)])  # P(X < k), good to 3e-6 for the spacing of w
    assert np.abs(below - poissons.cdf(k - 1, mean)).max() < 2e-5
    rounded = norm.cdf((k - 0.5 - mean) / np.sqrt(mean))  # a rounded normal number does not pass
    assert np.abs(rounded - poissons.cdf(k - 1, mean)).max() > 5e-4


@pytest.mark.parametrize("mean", [0.5, 30.0, 99.0, 101.0, 2500.0])
def test_drawn_counts_fit_poissons_distribution(mean: float) -> None:
    drawn = poisson(np.full((400, 500), mean, np.float32), generator(3, "counts", str(mean)))
    assert drawn.dtype == np.float32
    edges = np.unique(poissons.ppf(np.linspace(0.02, 0.98, 40), mean))
    seen = np.diff(
        np.concatenate([[0], np.searchsorted(np.sort(drawn.ravel()), edges, "right"), [drawn.size]])
    )
    expected = drawn.size * np.diff(np.concatenate([[0.0], poissons.cdf(edges, mean), [1.0]]))
    statistic = float(((seen - expected) ** 2 / expected).sum())
    assert statistic < chi2.ppf(1 - 1e-3, len(expected) - 1)


def test_dark_and_bright_pixels_side_by_side_keep_their_means() -> None:
    mean = np.tile(np.array([0.0, 5.0, 1000.0], np.float32), (50_000, 1))
    drawn = poisson(mean, generator(3, "side by side"))
    assert (drawn[:, 0] == 0).all()
    z = (drawn.mean(axis=0)[1:] - [5.0, 1000.0]) / np.sqrt(np.array([5.0, 1000.0]) / len(drawn))
    assert (np.abs(z) < 3.3).all()
