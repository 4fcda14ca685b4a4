"""Effect of the noise that outlines really have on the covariances of a picture's dots."""

from math import exp, inf, log, pi, sqrt
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64

from labcal.detect.edges.edge_model import STATE
from labcal.detect.edges.gamma_regression import gamma_regression
from labcal.detect.edges.harmonics import Harmonics, KeptFits, harmonic_sums
from labcal.detect.edges.noise_direction import neighbouring, noise_by_direction
from labcal.detect.edges.residuals import VARIANCE
from labcal.detect.edges.shared_shape import with_powers, without_shared
from labcal.detect.medians import median_of
from labcal.detect.stage_settings.edge import EdgeSettings

_LEAST = 1e-12
"""Of a dot's white noise that a harmonic has left, below which it says nothing."""


class OutlineNoise(NamedTuple):
    """The noise of a picture's outlines."""

    factor: float
    """Its variance over what the fits' residuals say, for a shift, in the mean of both axes."""
    by_direction: Float64[np.ndarray, "2 2"]
    """The covariance of a shift in units of that mean."""


def outline_noise(
    table: Float64[np.ndarray, "n c"], fits: KeptFits, flat: float, settings: EdgeSettings
) -> OutlineNoise:
    """Return the noise of a picture's outlines, for a shift; it is alike in all directions if it is white.

    Parameters
    ----------
    table : ndarray, shape (n, COLUMNS)
        Converged fits, see :func:`~labcal.detect.edges.gauss_newton.fit_all`.
    fits : KeptFits
        Of the same fits.
    flat : float
        The same as the noise beside the outlines says. It counts the more the fewer dots there are, and if
        it is 1, that of white noise, it holds where chance explains what differs from it.
    settings : EdgeSettings
    """
    some = table[:, VARIANCE] > 0.0  # a drawn picture may be without noise
    if not some.any():
        return OutlineNoise(flat, np.eye(2))
    if not some.all():
        table, fits = table[some], fits.select(some)
    radius = median_of(1.0 / np.sqrt(table[:, 2] * table[:, 4] - table[:, 3] ** 2))
    harmonics = chosen_harmonics(radius, settings)
    nearest = neighbouring(harmonics)
    numbers = np.array(sorted({*harmonics.numbers.tolist(), *nearest.numbers.tolist()}))
    sums = harmonic_sums(table, fits, numbers)
    deviation = np.sqrt(table[:, VARIANCE])
    sums[..., :2] /= deviation[:, None, None]
    step = (table[:, STATE] - table[:, STATE + 3]) / deviation
    powers = own_powers(sums[:, np.searchsorted(numbers, harmonics.numbers)], step)
    ratio, error = long_wave_ratio(powers, 2.0 * pi * radius / harmonics.numbers, settings)
    factor = beside_flat_parts(ratio, error, flat, settings)
    if factor == 1.0:
        return OutlineNoise(factor, np.eye(2))
    sums = sums[:, np.searchsorted(numbers, nearest.numbers)]
    kept = without_shared_shape(sums[..., :2], step)
    return OutlineNoise(factor, noise_by_direction(kept, sums[..., 2], nearest, settings))


def beside_flat_parts(ratio: float, error: float, flat: float, settings: EdgeSettings) -> float:
    """Return a picture's factor from what its edges and the flat parts beside them say.

    Parameters
    ----------
    ratio, error : float
        Of edges, and the standard deviation of its logarithm; infinite where there is nothing to estimate it
        from.
    flat : float
        Of the flat parts.
    settings : EdgeSettings
    """
    if not error < inf:
        return flat
    if flat == 1.0 and abs(log(ratio)) < settings.noise_chance_sigma * error:
        return 1.0
    trust = 1.0 / (1.0 + error**2)  # against the flat parts' word, which is good to a factor of e or so
    return exp(trust * log(ratio) + (1.0 - trust) * log(flat))


def chosen_harmonics(radius: float, settings: EdgeSettings) -> Harmonics:
    """Return the harmonics by which the noise along an outline is measured.

    Odd ones move opposite edges the same way, as a shift does. Even ones hold what pixels, lens and fit do
    to opposite edges alike: that moves no centre. The first and the second are the fit's own.

    Parameters
    ----------
    radius : float
        Of a usual dot of the picture, px.
    settings : EdgeSettings
    """
    around = 2.0 * pi * radius
    first = max(3, 1 + 2 * round(0.5 * (around / settings.noise_long_px - 1.0)))
    last = max(first, int(around / settings.noise_short_px))
    odd = 1 + (last - first) // 2
    stride = 2 * max(1, -(-odd // settings.noise_harmonics))
    return Harmonics(first, stride, 1 + (last - first) // stride)


def own_powers(
    sums: Float64[np.ndarray, "n k 3"], step: Float64[np.ndarray, " n"]
) -> Float64[np.ndarray, "n k 2"]:
    """Return the power of each dot's residuals without what all dots share, and that of white noise.

    All dots of a print, or of a renderer, may have the same shape. It shifts all alike, and is no noise.

    Parameters
    ----------
    sums : ndarray, shape (n, k, 3)
        See :func:`~labcal.detect.edges.harmonics.harmonic_sums`, over the dots' noise.
    step : ndarray, shape (n,)
        From dot to board, over the dot's noise.
    """
    kept = without_shared_shape(sums[..., :2], step)
    return with_powers(kept, sums)


def without_shared_shape(
    sums: Float64[np.ndarray, "n k 2"], step: Float64[np.ndarray, " n"]
) -> Float64[np.ndarray, "n k 2"]:
    """Return sums of each dot's residuals without what all dots share; `step` as of :func:`own_powers`."""
    return sums if len(sums) == 1 else without_shared(sums, step)


def long_wave_ratio(
    powers: Float64[np.ndarray, "n k 2"], wavelengths: Float64[np.ndarray, " k"], settings: EdgeSettings
) -> tuple[float, float]:
    """Return the variance of outlines over that of white noise at long waves, and its relative error.

    A shift is one long wave around the whole outline. Noise that is alike in neighbouring pixels is stronger
    in long waves than in short ones, and what compression or demosaicing leaves is often weaker. The
    logarithm of the variance is linear in the square of the wave number, as it is for noise that a Gauss
    function has smoothed; it is estimated by gamma regression (McCullagh and Nelder 1989, chapter 8) over
    all dots but those that fit far worse than the others. What grows with the wave by more than pixels are
    ever smoothed is the print's ragged outline, the same at every sight of a dot, and no noise: then shorter
    waves count alone.

    Parameters
    ----------
    powers : ndarray, shape (n, k, 2)
        See :func:`own_powers`.
    wavelengths : ndarray, shape (k,)
        Of the harmonics, px.
    settings : EdgeSettings

    Returns
    -------
    ratio : float
        NaN where there is nothing to estimate it from.
    error : float
        Standard deviation of its logarithm.
    """
    usual = _usual_powers(powers, settings)
    if usual is None:
        return float("nan"), inf
    ratio, weight = usual
    return _at_long_waves(ratio, weight, 1.0 / wavelengths**2, settings)


def smooth_wave_ratio(
    powers: Float64[np.ndarray, "n k 2"], wavelengths: Float64[np.ndarray, " k"], settings: EdgeSettings
) -> tuple[float, float]:
    """Return the same as :func:`long_wave_ratio`, with all that long waves hold, a ragged print's edges, too.

    Waves are alike where chance explains that they are not. Those of one corner go together somewhat, since
    its edges have few pixels: how much, the corners' scatter tells.

    Parameters
    ----------
    powers : ndarray, shape (n, k, 2)
        Seen and expected.
    wavelengths : ndarray, shape (k,)
        Px.
    settings : EdgeSettings

    Returns
    -------
    ratio, error : float
    """
    usual = _usual_powers(powers, settings)
    if usual is None:
        return float("nan"), inf
    ratio, weight = usual
    weight = weight / _shared_power(powers)
    square = 1.0 / wavelengths**2
    if len(ratio) > 1:
        _, slope, level_variance, slope_variance = gamma_regression(square, ratio, weight)
        if abs(slope) > settings.noise_chance_sigma * sqrt(slope_variance):
            slope = float(np.clip(slope, -steepest_slope(settings), steepest_slope(settings)))
            level = float(np.average(ratio * np.exp(-slope * square), weights=weight))
            return level, sqrt(level_variance)
    return float(np.average(ratio, weights=weight)), 1.0 / sqrt(float(weight.sum()))


def _shared_power(powers: Float64[np.ndarray, "n k 2"]) -> float:
    """Return the variance of a picture's mean power over that of independent waves, at least 1.

    By the scatter from corner to corner (the variance of a ratio estimator, Cochran 1977, section 2.11).
    """
    seen, expected = powers.sum(axis=1).T
    n, total = len(seen), float(expected.sum())
    ratio = float(seen.sum()) / total
    if n == 1 or not ratio > 0.0:
        return 1.0
    scatter = float(((seen - ratio * expected) ** 2).sum()) / total**2 * n / (n - 1.0)
    return max(1.0, scatter * total / ratio**2)


def _usual_powers(
    powers: Float64[np.ndarray, "n k 2"], settings: EdgeSettings
) -> tuple[Float64[np.ndarray, " k"], Float64[np.ndarray, " k"]] | None:
    """Return the ratio of each wave, seen over expected, and its weight, of all that fit as others do."""
    powers = powers[powers[:, :, 1].sum(axis=1) > _LEAST]
    if len(powers) == 0:
        return None
    each = powers[..., 0].sum(axis=1) / powers[..., 1].sum(axis=1)
    powers = powers[each <= settings.noise_outlier_factor * median_of(each)]
    seen, weight = powers.sum(axis=0).T
    if not (seen > 0.0).all() or not (weight > _LEAST).all():
        return None
    return seen / weight, weight


def steepest_slope(settings: EdgeSettings) -> float:
    """Return the greatest slope of the logarithm of a power over the squared wave number, px squared."""
    return float((2.0 * pi * settings.noise_smoothing_px) ** 2)  # of a Gauss function's power


def _at_long_waves(
    ratio: Float64[np.ndarray, " k"],
    weight: Float64[np.ndarray, " k"],
    square: Float64[np.ndarray, " k"],
    settings: EdgeSettings,
) -> tuple[float, float]:
    """Return the ratio at the wave number 0 and the error of its logarithm, from those at squared numbers."""
    steepest = steepest_slope(settings)
    first, slope = len(ratio) - 1, -steepest if len(ratio) > 1 else 0.0  # if all others are the print's
    for longest in range(len(ratio) - 1):
        some = slice(longest, None)
        level, steep, level_variance, slope_variance = gamma_regression(
            square[some], ratio[some], weight[some]
        )
        if abs(steep) <= steepest:
            return exp(level), sqrt(level_variance)
        if steep > -steepest - settings.noise_chance_sigma * sqrt(slope_variance):
            first, slope = longest, float(np.clip(steep, -steepest, steepest))
            break
    levels, weight = ratio[first:] * np.exp(-slope * square[first:]), weight[first:]
    return float(np.average(levels, weights=weight)), 1.0 / sqrt(float(weight.sum()))
