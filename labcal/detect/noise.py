"""How noise that is tied from pixel to pixel widens the covariances of a picture's dots."""

from dataclasses import dataclass

import numpy as np

_REACH = 2  # px: noise is looked at together over so many neighbours to either side
_SHADINGS = 4  # of the fit's six, about so many are spent on the flat parts (a small dot has none inside)
_LAGS = [(i, j) for i in range(-_REACH, _REACH + 1) for j in range(-_REACH, _REACH + 1)]
_FEWEST = 500  # pixels: less tells nothing


@dataclass(frozen=True)
class Scatter:
    """What one dot's fit tells of the noise.

    Attributes
    ----------
    residual : ndarray, shape (h, w)
        Residuals in the flat parts, dot and board away from the edge; 0 elsewhere.
    flat : ndarray of bool, shape (h, w)
        Where that is.
    gradient : ndarray, shape (2, h, w)
        Change of the grey values with the dot's centre, 0 outside the fit.
    """

    residual: np.ndarray
    flat: np.ndarray
    gradient: np.ndarray


def noise_factor(scatters: list[Scatter], shadings: float = _SHADINGS) -> float:
    """Return by how much the covariances of a picture's fits are too small, at least 1.

    Demosaicing and compression tie the noise of neighbouring pixels together. Its autocorrelation, pooled
    over the flat parts around all dots, is weighed with that of the fits' gradients: the ratio of ``J' C J``
    to ``J' J`` for the noise's correlation matrix C. The edges themselves are left out, since what a print's
    outline does there is no noise. `shadings` is how many of a fit's parameters are spent on the flat parts.
    """
    count = sum(int(scatter.flat.sum()) for scatter in scatters)
    energy = sum(float((scatter.residual**2).sum()) for scatter in scatters)
    if count < _FEWEST or energy <= 0:
        return 1.0
    # Residuals of a fit are tied a little even where the noise is not.
    spent = shadings * len(scatters) / count
    factor = 0.0
    weight = sum(float((scatter.gradient**2).sum()) for scatter in scatters)
    for lag in _LAGS:
        pairs = sum(_lagged(scatter.flat.astype(float), lag) for scatter in scatters)
        together = sum(_lagged(scatter.residual, lag) for scatter in scatters)
        correlation = 1.0 if lag == (0, 0) else together / max(pairs, 1.0) / (energy / count) + spent
        share = sum(_lagged(scatter.gradient[k], lag) for scatter in scatters for k in range(2)) / weight
        factor += correlation * share
    return max(1.0, factor)


def _lagged(values: np.ndarray, lag: tuple[int, int]) -> float:
    """Return the sum of products of values `lag` rows and columns apart."""
    i, j = lag if lag[0] >= 0 else (-lag[0], -lag[1])  # the same pairs in the other order
    rows, columns = values.shape
    upper, lower = values[: rows - i], values[i:]
    if j >= 0:
        return float((upper[:, : max(columns - j, 0)] * lower[:, j:]).sum())
    return float((upper[:, -j:] * lower[:, : max(columns + j, 0)]).sum())
