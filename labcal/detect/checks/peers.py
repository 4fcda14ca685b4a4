"""What a dot should show by the other dots of its picture: noise and darkness that go with the light."""

import numpy as np
from jaxtyping import Float64

_FEWEST = 8
"""Fewer dots tell no trend."""
_LEAST_SPAN = 0.05
"""Of the light, between the darker half of the dots and the brighter one: less tells no trend either."""
_LEAST_NOISE, _LEAST_SHARE = 0.01, 0.6
"""What a fit may always leave: as a share of the step, and in variance of that of the picture's dots."""


def misfits(
    dark: Float64[np.ndarray, " n"], light: Float64[np.ndarray, " n"], variance: Float64[np.ndarray, " n"]
) -> Float64[np.ndarray, " n"]:
    """Return the standard deviations of dots' residuals over what is usual in their light, NaN for NaN.

    Noise grows with light, linearly in its variance for photons. What a fit leaves beyond it is no noise:
    something lies over the dot or beside it.

    Parameters
    ----------
    dark, light : ndarray, shape (n,)
        Dot and board, the darker one and the brighter one, grey values above no light.
    variance : ndarray, shape (n,)
        Of the residuals of its fit.
    """
    known = np.isfinite(variance)
    least = _LEAST_SHARE * np.median(variance[known]) if known.any() else 0.0
    usual = np.maximum(_trend(light, variance), np.maximum(least, (_LEAST_NOISE * (light - dark)) ** 2))
    deviations: np.ndarray = np.sqrt(variance / np.where(usual > 0.0, usual, 1.0))
    return deviations


def paleness(board: Float64[np.ndarray, " n"], dot: Float64[np.ndarray, " n"]) -> Float64[np.ndarray, " n"]:
    """Return by how much of the step dots are brighter than is usual on so bright a board, NaN for NaN.

    Always 0 for dots that are brighter than the board.

    Parameters
    ----------
    board, dot : ndarray, shape (n,)
        Grey values above no light.
    """
    usual = _trend(board, dot)
    step = board - usual
    pale: np.ndarray = (dot - usual) / np.where(step > 0.0, step, np.inf)
    return pale


def _trend(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return a line through the medians of the lower and the upper half, which a third may be far off."""
    known = np.isfinite(x) & np.isfinite(y)
    if not known.any():
        return np.full(len(x), np.nan)
    middle = float(np.median(x[known]))
    lower, upper = known & (x <= middle), known & (x > middle)
    flat = np.full(len(x), np.median(y[known]))
    if known.sum() < _FEWEST or not upper.any():
        return flat
    (x0, y0), (x1, y1) = ((np.median(x[half]), np.median(y[half])) for half in (lower, upper))
    if x1 - x0 < _LEAST_SPAN * abs(x1):
        return flat
    return np.asarray(y0 + (y1 - y0) / (x1 - x0) * (x - x0))
