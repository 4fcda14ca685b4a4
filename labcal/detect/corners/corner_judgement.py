"""Uncertainty of the fit of a corner, from its residuals; in compiled code."""

from math import floor, sqrt
from typing import NamedTuple

import numpy as np

from labcal.detect.cholesky import factorise, solve
from labcal.detect.compiled import compiled
from labcal.detect.corners.corner_kernel import PARAMETERS, Pixels, fill_jacobian
from labcal.detect.corners.edge_waves import RESIDUAL, ROWS, wave_powers
from labcal.detect.edges.residuals import LAGS, REACH, SUMS
from labcal.detect.lane_sums import greatest, total, total_of_products
from labcal.detect.row_products import HIGH, add_own_products, add_products, filled_up

_SINGULAR = 1e-13
"""A pivot that falls to so much of its diagonal entry."""
_TOGETHER = 3
"""Lags; the number of those to the right and down is a multiple of it."""


class JudgementLimits(NamedTuple):
    """The settings of corners that their uncertainty takes."""

    tone_levels: int
    min_variance_share: float
    flat_blurs: float


class CornerFit(NamedTuple):
    """The fit of one corner, with its uncertainty.

    Attributes
    ----------
    centre : ndarray, shape (2,)
        Where the edges cross, px.
    covariance : ndarray, shape (2, 2)
        Of `centre`, px squared, for noise that is independent from pixel to pixel.
    roughness : float
        Root mean square residual over the step from black to white.
    sums : ndarray, shape (LAGS, SUMS)
        Sums of the residuals over the noise, see :func:`labcal.detect.edges.noise.noise_factor`.
    powers : ndarray, shape (WAVES, 2)
        Power of the residuals along the edges by wave, and that of the noise which the covariance counts
        with, see :func:`labcal.detect.corners.edge_waves.wave_powers`.
    reach : float
        The greatest distance of a pixel of the fit from the corner, px.
    """

    centre: np.ndarray
    covariance: np.ndarray
    roughness: float
    sums: np.ndarray
    powers: np.ndarray
    reach: float


@compiled
def judged(
    state: np.ndarray, pixels: Pixels, mask: np.ndarray, free: int, limits: JudgementLimits
) -> tuple[bool, np.ndarray, np.ndarray, np.ndarray, float]:
    """Return whether there are pixels enough, and covariance, sums, powers and reach of :class:`CornerFit`.

    Parameters
    ----------
    state : ndarray, shape (PARAMETERS,)
    pixels : tuple
    mask : ndarray of bool, shape (h, w)
        Which pixels of their rectangle these are.
    free : int
        Number of parameters that were fitted, from the first one on; the others are taken for known.
    limits : JudgementLimits
    """
    n = len(pixels[1])
    table, board, off_edges = np.zeros((ROWS, filled_up(n))), np.empty(n), np.empty(n)
    fill_jacobian(state, pixels, (table[RESIDUAL], table[:PARAMETERS], board, off_edges))
    for i in range(free, RESIDUAL):
        row = table[i]
        for k in range(n):
            row[k] = 0.0
    away = pixels[0] - state[:2].copy().reshape(2, 1)
    return judged_rows((table, board, off_edges), away, mask, np.zeros((free, free)), limits)


@compiled
def judged_rows(
    rows: tuple[np.ndarray, np.ndarray, np.ndarray],
    away: np.ndarray,
    mask: np.ndarray,
    prior: np.ndarray,
    limits: JudgementLimits,
) -> tuple[bool, np.ndarray, np.ndarray, np.ndarray, float]:
    """Return the same as :func:`judged` of what a fit has linearised.

    Parameters
    ----------
    rows : (ndarray, ndarray, ndarray)
        Derivatives, those by the place first, and residuals, as of
        :func:`labcal.detect.corners.edge_waves.wave_powers`; the pattern, and distances from edges in blurs,
        both of shape (n,).
    away : ndarray, shape (2, n)
        Of the pixels from the corner, px.
    mask : ndarray of bool, shape (h, w)
    prior : ndarray, shape (p, p)
        Information on the p free parameters from elsewhere, over that of a pixel.
    limits : JudgementLimits
    """
    table, board, off_edges = rows
    n, free, size = len(board), len(prior), len(table)
    residual = table[size - 2]
    covariance, powers = np.zeros((2, 2)), np.zeros((1, 2))
    sums = np.zeros((LAGS, SUMS))
    noise, levels = _without_tone(residual[:n], board, limits.tone_levels)
    freedom = n - PARAMETERS - levels
    plain, even = np.zeros((size, size)), free + free % HIGH
    add_own_products(table, table.shape[1], plain)
    factor = plain.copy()
    for i in range(free):
        for j in range(i + 1):
            factor[i, j] += prior[i, j]
    if freedom < PARAMETERS or not factorise(factor, free, _SINGULAR):
        return False, covariance, sums, powers, 0.0
    variance = _variance(noise, board, limits.min_variance_share) * (n / freedom)
    weighted, fits = np.zeros((even, table.shape[1])), np.zeros((even, even))
    for p in range(free):
        row, out = table[p], weighted[p]
        for k in range(n):
            out[k] = row[k] * variance[k]
    add_products(table[:even], weighted, (0, table.shape[1]), fits)
    _write_covariance(factor, fits, prior * (total(variance) / n), covariance)
    # Variance of Student's distribution: that of the noise is estimated from the corner's own pixels.
    covariance *= freedom / (freedom - 2.0)
    distance = np.empty(n)
    for k in range(n):
        distance[k] = sqrt(away[0, k] * away[0, k] + away[1, k] * away[1, k])
    reach = greatest(distance)
    powers = wave_powers((table, weighted), (plain, factor, fits), free, (distance, reach), variance)
    _write_products((table[0], table[1], residual), off_edges, mask, limits.flat_blurs, sums)
    return True, covariance, sums, powers, reach


@compiled
def place_error(
    table: np.ndarray, board: np.ndarray, fit: tuple[np.ndarray, np.ndarray], limits: JudgementLimits
) -> float:
    """Return the error of a corner's place along either axis, px, as the covariance of :func:`judged_rows`.

    It is infinite where there are too few pixels. `fit` holds the Cholesky factor of the normal matrix, and
    the information from elsewhere.
    """
    root, prior = fit
    n, free, residual = len(board), len(prior), table[len(table) - 2]
    noise, levels = _without_tone(residual[:n], board, limits.tone_levels)
    freedom = n - PARAMETERS - levels
    if freedom < PARAMETERS:
        return np.inf
    variance = _variance(noise, board, limits.min_variance_share) * (n / freedom)
    usual, squares, gain = total(variance) / n, 0.0, np.empty(n)
    for axis in range(2):
        weight = np.zeros(free)
        weight[axis] = 1.0
        solve(root, weight)
        gain[:] = 0.0
        for p in range(free):
            row, by = table[p], weight[p]
            for k in range(n):
                gain[k] += by * row[k]
        squares += (
            total_of_products(gain * gain, variance) + (weight * (prior * weight).sum(axis=1)).sum() * usual
        )
    return sqrt(0.5 * squares * freedom / (freedom - 2.0))


@compiled
def _write_covariance(
    factor: np.ndarray, fits: np.ndarray, prior: np.ndarray, covariance: np.ndarray
) -> None:
    """Write the covariance of the corner's place, ``M (J v J' + P) M'``.

    M holds the first two rows of the inverse normal matrix, `fits` is ``J v J'`` for derivatives J and the
    pixels' variances v, and P is the information of `prior` at the mean of these.
    """
    free = len(prior)
    inverse = np.zeros((2, free))
    for axis in range(2):
        inverse[axis, axis] = 1.0
        solve(factor, inverse[axis])
    for i in range(2):
        for j in range(2):
            for p in range(free):
                along = 0.0
                for q in range(free):
                    along += inverse[j, q] * (fits[p, q] + prior[p, q])
                covariance[i, j] += inverse[i, p] * along


@compiled
def _without_tone(residual: np.ndarray, board: np.ndarray, tone_levels: int) -> tuple[np.ndarray, int]:
    """Return residuals less their means by level between black and white; and how many levels there are.

    What the residual is on average at a level is a tone curve and no noise.
    """
    level = np.empty(len(board), dtype=np.int64)
    sums, count = np.zeros(4 * tone_levels + 1), np.zeros(4 * tone_levels + 1)
    for k in range(len(board)):
        at = floor(tone_levels * board[k] + 0.5) + 2 * tone_levels
        level[k] = min(max(at, 0), 4 * tone_levels)
    for k in range(len(board)):
        sums[level[k]] += residual[k]
        count[level[k]] += 1.0
    mean, noise = sums / np.maximum(count, 1.0), np.empty(len(board))
    for k in range(len(board)):
        noise[k] = residual[k] - mean[level[k]]
    return noise, int((count > 0.0).sum())


@compiled
def _variance(noise: np.ndarray, board: np.ndarray, least: float) -> np.ndarray:
    """Return the noise's variance at every pixel, linear from black to white: photons, tone curves."""
    squares, n = noise * noise, len(noise)
    mean, middle = total(squares) / n, total(board) / n
    away = board - middle
    spread = total_of_products(away, away)
    slope = total_of_products(away, squares) / spread if spread > 0.0 else 0.0
    variance: np.ndarray = np.maximum(mean + slope * away, least * mean)
    return variance


@compiled
def _write_products(
    rows: tuple[np.ndarray, np.ndarray, np.ndarray],
    off_edges: np.ndarray,
    mask: np.ndarray,
    flat_blurs: float,
    sums: np.ndarray,
) -> None:
    """Write the sums of products of pixels at all distances; the edges are left out of the residuals.

    `rows` are the derivatives by the place and the residuals.
    """
    (by_x, by_y, residual), n = rows, len(off_edges)
    height, width = mask.shape
    wide = width + 2 * REACH
    number, places = np.full((height + REACH) * wide, n), np.empty(n, dtype=np.int64)
    k = 0
    for j in range(height):
        for i in range(width):
            if mask[j, i]:
                places[k] = j * wide + i + REACH
                number[places[k]] = k
                k += 1
    # Pixel n is none: all of its values are 0.
    values = np.zeros((n + 1, 4))
    for k in range(n):
        flat = 1.0 if off_edges[k] > flat_blurs else 0.0
        values[k, 0], values[k, 1], values[k, 2], values[k, 3] = flat, flat * residual[k], by_x[k], by_y[k]
    # Three lags at a time, since a sum must wait for what was added before.
    for lag in range(REACH + 1, LAGS, _TOGETHER):
        first, second, third = _shift(lag, wide), _shift(lag + 1, wide), _shift(lag + 2, wide)
        a = b = c = d = a2 = b2 = c2 = d2 = a3 = b3 = c3 = d3 = 0.0
        for k in range(n):
            own, one = values[k], values[number[places[k] + first]]
            two, three = values[number[places[k] + second]], values[number[places[k] + third]]
            a, b, c, d = a + own[0] * one[0], b + own[1] * one[1], c + own[2] * one[2], d + own[3] * one[3]
            a2, b2 = a2 + own[0] * two[0], b2 + own[1] * two[1]
            c2, d2 = c2 + own[2] * two[2], d2 + own[3] * two[3]
            a3, b3 = a3 + own[0] * three[0], b3 + own[1] * three[1]
            c3, d3 = c3 + own[2] * three[2], d3 + own[3] * three[3]
        for more, pairs, energy, both in ((0, a, b, c + d), (1, a2, b2, c2 + d2), (2, a3, b3, c3 + d3)):
            sums[lag + more, 0], sums[lag + more, 1], sums[lag + more, 2] = pairs, energy, both
    a = b = c = d = 0.0
    for k in range(n):
        own = values[k]
        a, b, c, d = a + own[0] * own[0], b + own[1] * own[1], c + own[2] * own[2], d + own[3] * own[3]
    sums[REACH, 0], sums[REACH, 1], sums[REACH, 2] = a, b, c + d
    for lag in range(REACH):  # to the left, as to the right
        sums[lag] = sums[2 * REACH - lag]


@compiled
def _shift(lag: int, wide: int) -> int:
    """Return how far away a lag is among pixels row by row, of a rectangle so wide."""
    down = lag // (2 * REACH + 1)
    return down * wide + lag - down * (2 * REACH + 1) - REACH
