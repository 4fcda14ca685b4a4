"""How noise that is tied from pixel to pixel widens the covariances of a picture's dots."""

import numpy as np

from labcal.detect.edge_kernel import LAGS, REACH

_SHADINGS = 4
"""Of the fit's six, about so many are spent on the flat parts (a small dot has none inside)."""
_FEWEST = 500
"""Pixels: fewer tell nothing."""


def noise_factor(sums: np.ndarray, dots: int, shadings: float = _SHADINGS) -> float:
    """Return by how much the covariances of a picture's fits are too small, at least 1.

    Demosaicing and compression tie the noise of neighbouring pixels together. Its autocorrelation, pooled
    over the flat parts around the dots, is weighed with that of the fits' gradients: the ratio of ``J' C J``
    to ``J' J`` for the noise's correlation matrix C.

    Parameters
    ----------
    sums : ndarray, shape (LAGS, SUMS)
        By how many pixels down and across: pairs of flat pixels, products of their residuals, and products
        of the fits' gradients.
    dots : int
        How many dots are in it.
    shadings : float
        How many of a fit's parameters are spent on the flat parts.
    """
    count, energy, weight = sums[REACH]
    if count < _FEWEST or energy <= 0:
        return 1.0
    # Residuals of a fit are tied a little even where the noise is not.
    spent = shadings * dots / count
    correlation = sums[:, 1] / np.maximum(sums[:, 0], 1.0) / (energy / count) + spent
    correlation[REACH] = 1.0
    times = np.full(LAGS, 2.0)  # a pair up is the pair down the other way round
    times[: 2 * REACH + 1] = 1.0
    return max(1.0, float((times * correlation * sums[:, 2]).sum() / weight))
