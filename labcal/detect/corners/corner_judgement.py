"""Uncertainty of the fit of a corner, from its residuals; in compiled code."""

from dataclasses import dataclass
from math import floor, hypot
from typing import NamedTuple

import numpy as np

from labcal.detect.cholesky import factorise, solve
from labcal.detect.compiled import compiled
from labcal.detect.corners.corner_kernel import PARAMETERS, Pixels, fill_jacobian
from labcal.detect.corners.edge_waves import wave_powers
from labcal.detect.edges.residuals import LAGS, REACH, SUMS

_SINGULAR = 1e-13
"""A pivot that falls to so much of its diagonal entry."""


class JudgementLimits(NamedTuple):
    """The settings of corners that their uncertainty takes."""

    tone_levels: int
    min_variance_share: float
    flat_blurs: float


@dataclass(frozen=True)
class CornerFit:
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
    rows = (np.empty(n), np.empty((PARAMETERS, n)), np.empty(n), np.empty(n))
    fill_jacobian(state, pixels, rows)
    rows = (rows[0], rows[1][:free].copy(), rows[2], rows[3])
    away = pixels[0] - state[:2].copy().reshape(2, 1)
    return judged_rows(rows, away, mask, np.zeros((free, free)), limits)


@compiled
def judged_rows(
    rows: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray],
    away: np.ndarray,
    mask: np.ndarray,
    prior: np.ndarray,
    limits: JudgementLimits,
) -> tuple[bool, np.ndarray, np.ndarray, np.ndarray, float]:
    """Return the same as :func:`judged` of what a fit has linearised.

    Parameters
    ----------
    rows : tuple of ndarray
        As of :func:`labcal.detect.corners.corner_kernel.fill_jacobian`; derivatives by the place first.
    away : ndarray, shape (2, n)
        Of the pixels from the corner, px.
    mask : ndarray of bool, shape (h, w)
    prior : ndarray, shape (p, p)
        Information on the parameters from elsewhere, over that of a pixel.
    limits : JudgementLimits
    """
    n, free = len(rows[0]), len(prior)
    residual, jacobian, board, off_edges = rows
    covariance, powers = np.zeros((2, 2)), np.zeros((1, 2))
    sums = np.zeros((LAGS, SUMS))
    noise, levels = _without_tone(residual, board, limits.tone_levels)
    freedom = n - PARAMETERS - levels
    factor = jacobian @ jacobian.T + prior
    if freedom < PARAMETERS or not factorise(factor, free, _SINGULAR):
        return False, covariance, sums, powers, 0.0
    gain, weights = np.empty((2, n)), np.zeros((2, free))
    for axis in range(2):
        weights[axis, axis] = 1.0
        solve(factor, weights[axis])
        gain[axis] = weights[axis] @ jacobian
    variance = _variance(noise, board, limits.min_variance_share) * (n / freedom)
    for i in range(2):
        for j in range(2):
            covariance[i, j] = (gain[i] * variance * gain[j]).sum()
            covariance[i, j] += variance.mean() * (weights[i] * (prior @ weights[j])).sum()
    distance = np.empty(n)
    for k in range(n):
        distance[k] = hypot(away[0, k], away[1, k])
    powers = wave_powers((residual, jacobian, factor), distance, gain, variance)
    _add_products(residual, off_edges, jacobian, mask, limits.flat_blurs, sums)
    return True, covariance, sums, powers, distance.max()


@compiled
def _without_tone(residual: np.ndarray, board: np.ndarray, tone_levels: int) -> tuple[np.ndarray, int]:
    """Return residuals less their means by level between black and white; and how many levels there are.

    What the residual is on average at a level is a tone curve and no noise.
    """
    level = np.empty(len(board), dtype=np.int64)
    total, count = np.zeros(4 * tone_levels + 1), np.zeros(4 * tone_levels + 1)
    for k in range(len(board)):
        at = floor(tone_levels * board[k] + 0.5) + 2 * tone_levels
        level[k] = min(max(at, 0), 4 * tone_levels)
        total[level[k]] += residual[k]
        count[level[k]] += 1.0
    mean = total / np.maximum(count, 1.0)
    return residual - mean[level], int((count > 0.0).sum())


@compiled
def _variance(noise: np.ndarray, board: np.ndarray, least: float) -> np.ndarray:
    """Return the noise's variance at every pixel, linear from black to white: photons, tone curves."""
    squares = noise * noise
    mean, middle = squares.mean(), board.mean()
    away = board - middle
    spread = (away * away).sum()
    slope = (away * squares).sum() / spread if spread > 0.0 else 0.0
    variance: np.ndarray = np.maximum(mean + slope * away, least * mean)
    return variance


@compiled
def _add_products(
    residual: np.ndarray,
    off_edges: np.ndarray,
    jacobian: np.ndarray,
    mask: np.ndarray,
    flat_blurs: float,
    sums: np.ndarray,
) -> None:
    """Add products of pixels at all distances to sums; the edges themselves are left out of the residuals."""
    height, width = mask.shape
    number = np.full((height + REACH, width + 2 * REACH), -1)
    k = 0
    for j in range(height):
        for i in range(width):
            if mask[j, i]:
                number[j, i + REACH] = k
                k += 1
    for j in range(height):
        for i in range(REACH, width + REACH):
            here = number[j, i]
            if here < 0:
                continue
            flat = off_edges[here] > flat_blurs
            for lag in range(LAGS):
                down = lag // (2 * REACH + 1)
                there = number[j + down, i + lag - down * (2 * REACH + 1) - REACH]
                if there < 0:
                    continue
                sums[lag, 2] += (
                    jacobian[0, here] * jacobian[0, there] + jacobian[1, here] * jacobian[1, there]
                )
                if flat and off_edges[there] > flat_blurs:
                    sums[lag, 0] += 1.0
                    sums[lag, 1] += residual[here] * residual[there]
