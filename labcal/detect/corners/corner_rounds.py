"""Rounds of fits of all corners of a board, in one compiled call each."""

from typing import NamedTuple

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.corners.corner_judgement import JudgementLimits, judged
from labcal.detect.corners.corner_kernel import (
    CHESSBOARD,
    LIGHT_KNOWN,
    PARAMETERS,
    FitLimits,
    settled,
)
from labcal.detect.corners.corner_pixels import PackedPixels, mask_of, packed, pixels_of
from labcal.detect.corners.corner_window import WindowLimits, narrowest, near_edges, window_arrays
from labcal.detect.corners.edge_waves import WAVES
from labcal.detect.corners.first_fit import FirstLimits, first_fit
from labcal.detect.edges.residuals import LAGS, SUMS

Places = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
"""Centres (n, 2), axes (n, 2, 2), bends (n, 2) and the values of :class:`WindowLimits` (n, 5) of corners."""
Round = tuple[np.ndarray, np.ndarray, np.ndarray, PackedPixels]
"""Whether each fit is one (n,), states (n, PARAMETERS), root mean square residuals (n,), and pixels."""


class WiderLimits(NamedTuple):
    """The settings of corners that a second fit takes, besides those of Gauss-Newton."""

    first_tolerance_px: float
    tolerance_px: float
    marker_guard_blurs: float
    edge_blurs: float
    min_pixels: int
    max_blur_squares: float
    max_refit_blurs: float


@compiled
def first_fits(grey: np.ndarray, places: Places, limits: tuple[FirstLimits, FitLimits]) -> Round:
    """Return the first fits of corners."""
    centres, axes, bends, around = places
    n = len(centres)
    ok, states, rms = np.zeros(n, dtype=np.bool_), np.zeros((n, PARAMETERS)), np.zeros(n)
    windows = []
    for k in range(n):
        here = WindowLimits(around[k, 0], around[k, 1], around[k, 2], around[k, 3], around[k, 4])
        ok[k], states[k], window, rms[k] = first_fit(grey, (centres[k], axes[k], bends[k]), here, limits)
        windows.append(window)
    return ok, states, rms, packed(windows)


@compiled
def wide_fits(
    grey: np.ndarray, places: Places, first: np.ndarray, limits: tuple[WiderLimits, FitLimits]
) -> Round:
    """Return the second fits of corners, from the states of the first ones (n, PARAMETERS) on."""
    centres, axes, bends, around = places
    own, newton = limits
    n = len(centres)
    ok, states, rms = np.zeros(n, dtype=np.bool_), first.copy(), np.zeros(n)
    windows = []
    for k in range(n):
        here = WindowLimits(around[k, 0], around[k, 1], around[k, 2], around[k, 3], around[k, 4])
        state = states[k]
        state[:2] = 0.0
        blur, narrow = max(state[4], state[5]), narrowest(axes[k])
        guard = own.marker_guard_blurs * blur / narrow
        mask, offset, value, gap = window_arrays(grey, (centres[k], axes[k]), here, guard)
        mask, offset, value = near_edges((mask, offset, value), state, own.edge_blurs)
        windows.append((mask, offset, value, gap))
        if len(value) < own.min_pixels:
            continue
        pixels = (offset, value, gap, bends[k], CHESSBOARD)
        rms[k] = settled(state, pixels, (own.first_tolerance_px, PARAMETERS), newton)
        ok[k] = (
            rms[k] >= 0.0
            and state[7] > 0.0
            and max(state[4], state[5]) <= own.max_blur_squares * narrow
            and state[0] ** 2 + state[1] ** 2 <= (own.max_refit_blurs * blur) ** 2
        )
    return ok, states, rms, packed(windows)


@compiled
def light_fits(
    pixels: PackedPixels,
    patterns: np.ndarray,
    bends: np.ndarray,
    states: np.ndarray,
    limits: tuple[WiderLimits, FitLimits],
) -> np.ndarray:
    """Fit states (n, PARAMETERS), in place, with the slope of the light as they have it.

    Return the root mean square residuals (n,), negative where a fit does not converge.
    """
    own, newton = limits
    rms = np.full(len(states), -1.0)
    for k in range(len(states)):
        window = pixels_of(pixels, k, bends[k], patterns[k])
        if len(window[1]) >= own.min_pixels:
            rms[k] = settled(states[k], window, (own.tolerance_px, LIGHT_KNOWN), newton)
    return rms


@compiled
def judgements(
    pixels: PackedPixels,
    patterns: np.ndarray,
    bends: np.ndarray,
    fits: tuple[np.ndarray, np.ndarray],
    limits: JudgementLimits,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return whether there are pixels enough (n,), covariances, sums, powers and reaches of fits.

    `fits` holds the states (n, PARAMETERS), and how many of the parameters were fitted (n,).
    """
    states, free = fits
    n = len(states)
    ok, reach = np.zeros(n, dtype=np.bool_), np.zeros(n)
    covariance, sums, powers = np.zeros((n, 2, 2)), np.zeros((n, LAGS, SUMS)), np.zeros((n, WAVES, 2))
    for k in range(n):
        window = pixels_of(pixels, k, bends[k], patterns[k])
        fine, own, products, waves, far = judged(states[k], window, mask_of(pixels, k), free[k], limits)
        if fine:
            ok[k], covariance[k], sums[k], powers[k], reach[k] = fine, own, products, waves, far
    return ok, covariance, sums, powers, reach
