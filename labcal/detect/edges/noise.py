"""Effect of noise that is correlated from pixel to pixel on the covariances of a picture's dots."""

import numpy as np

from labcal.detect.edges.residuals import LAGS, REACH
from labcal.detect.medians import median_of
from labcal.detect.stage_settings.edge import EdgeSettings

_SHADINGS = 4
"""Of the fit's six, about so many are spent on the flat parts (a small dot has none inside)."""
_OF_A_MEDIAN = 1.2533
"""The standard deviation of a median over that of a mean."""


def noise_factor(sums: np.ndarray, settings: EdgeSettings, shadings: float = _SHADINGS) -> float:
    """Return by how much the covariances of a picture's fits are too small, at least 1.

    Demosaicing and compression correlate the noise of neighbouring pixels. Its autocorrelation over the
    flat parts around a dot is weighed with that of the fit's gradients: the ratio of ``J' C J`` to ``J' J``
    for the noise's correlation matrix C. The median over dots counts, since the few that a model fits badly
    have residuals that only look like correlated noise.

    Parameters
    ----------
    sums : ndarray, shape (n, LAGS, SUMS)
        For every dot, by how many pixels down and across: pairs of flat pixels, products of their residuals,
        and products of the fit's gradients.
    settings : EdgeSettings
    shadings : float
        How many of a fit's parameters are spent on the flat parts.
    """
    count, energy, weight = sums[:, REACH].T
    sums = sums[(count > 0.0) & (energy > 0.0) & (weight > 0.0)]
    count, energy, weight = sums[:, REACH].T
    if count.sum() < settings.noise_min_pixels:
        return 1.0
    pairs = np.maximum(sums[..., 0], 1.0)
    # Residuals of a fit are correlated a little even where the noise is not.
    correlation = sums[..., 1] / pairs * (count / energy)[:, None] + (shadings / count)[:, None]
    times = np.full(LAGS, 2.0)  # a pair up is the pair down the other way round
    times[: 2 * REACH + 1] = 1.0
    share = times * sums[..., 2] / weight[:, None]
    share[:, REACH] = 0.0
    excess = (share * correlation).sum(axis=1)
    # Row 0 holds every pair twice.
    variance = (share**2 / pairs * np.where(times > 1.0, 1.0, 2.0)).sum(axis=1)
    chance = _OF_A_MEDIAN * np.sqrt(variance.mean() / len(sums))
    typical = median_of(excess)
    return 1.0 + typical if typical > settings.noise_chance_sigma * chance else 1.0
