"""Noise and darkness of a dot against those of the picture's other dots in the same light."""

import numpy as np
from jaxtyping import Float64

from labcal.detect.medians import median_of
from labcal.detect.stage_settings.quality import QualitySettings


def misfits(
    dark: Float64[np.ndarray, " n"],
    light: Float64[np.ndarray, " n"],
    variance: Float64[np.ndarray, " n"],
    settings: QualitySettings,
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
    settings : QualitySettings
    """
    known = np.isfinite(variance)
    least = settings.min_variance_share * median_of(variance[known]) if known.any() else 0.0
    least = np.maximum(least, (settings.min_noise_share * (light - dark)) ** 2)
    usual = np.maximum(_trend(light, variance, settings), least)
    deviations: np.ndarray = np.sqrt(variance / np.where(usual > 0.0, usual, 1.0))
    return deviations


def paleness(
    board: Float64[np.ndarray, " n"], dot: Float64[np.ndarray, " n"], settings: QualitySettings
) -> Float64[np.ndarray, " n"]:
    """Return by how much of the step dots are brighter than is usual on so bright a board, NaN for NaN.

    Always 0 for dots that are brighter than the board.

    Parameters
    ----------
    board, dot : ndarray, shape (n,)
        Grey values above no light.
    settings : QualitySettings
    """
    usual = _trend(board, dot, settings)
    step = board - usual
    pale: np.ndarray = (dot - usual) / np.where(step > 0.0, step, np.inf)
    return pale


def _trend(x: np.ndarray, y: np.ndarray, settings: QualitySettings) -> np.ndarray:
    """Return a line through the medians of the lower and the upper half, which a third may be far off."""
    known = np.isfinite(x) & np.isfinite(y)
    if not known.any():
        return np.full(len(x), np.nan)
    middle = float(median_of(x[known]))
    lower, upper = known & (x <= middle), known & (x > middle)
    flat = np.full(len(x), median_of(y[known]))
    if known.sum() < settings.trend_min_dots or not upper.any():
        return flat
    (x0, y0), (x1, y1) = ((median_of(x[half]), median_of(y[half])) for half in (lower, upper))
    if x1 - x0 < settings.trend_min_span_share * abs(x1):
        return flat
    return np.asarray(y0 + (y1 - y0) / (x1 - x0) * (x - x0))
