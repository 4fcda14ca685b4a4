"""Photon noise: Poisson counts of many pixels, several times faster than by rejection sampling."""

import numpy as np

FEW = 100.0
"""Mean counts below this are drawn exactly; above, the total variation from Poisson is below 2e-5."""


def poisson(mean: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """Draw Poisson counts.

    Above a mean of 100, a normal number w becomes the count

        floor(m + sqrt(m) w + 1/3 + w^2/6 - (w/36 + w^3/72) / sqrt(m)),

    the asymptotic inverse of Poisson's distribution (Giles, "Algorithm 955", ACM TOMS 42, 2016; it is the
    Cornish-Fisher expansion, for counts). Mean, variance and skewness are those of Poisson; a rounded normal
    number, for comparison, is off by a total variation of 4e-3 at a mean of 1000.

    Parameters
    ----------
    mean : ndarray, float32
        Mean counts, not negative.
    random : numpy.random.Generator

    Returns
    -------
    ndarray, float32, of the shape of `mean`
        Whole numbers.
    """
    w = random.standard_normal(mean.shape, dtype=np.float32)
    counts = _quantile(np.maximum(mean, np.float32(FEW)), w)
    few = mean < FEW
    if few.any():
        counts[few] = random.poisson(mean[few])
    return counts


def _quantile(mean: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Return the Poisson counts with the same quantiles as normal numbers."""
    kind = mean.dtype.type
    root = np.sqrt(mean)
    square = w * w
    counts: np.ndarray = square * kind(-1 / 72) - kind(1 / 36)
    counts /= root
    counts += root
    counts *= w
    square *= kind(1 / 6)
    counts += square
    counts += mean + kind(1 / 3)
    np.floor(counts, out=counts)
    return counts
