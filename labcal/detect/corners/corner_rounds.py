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
    settled_with,
    take_known_light,
)
from labcal.detect.corners.corner_pixels import PackedPixels, mask_of, packed, pixels_of
from labcal.detect.corners.corner_rows import ROWS
from labcal.detect.corners.corner_window import (
    Places,
    WindowLimits,
    narrowest,
    near_edges,
    window_arrays,
    with_clipped,
)
from labcal.detect.corners.edge_waves import WAVES
from labcal.detect.corners.first_fit import FirstLimits, first_fit, leaves_out_clipped
from labcal.detect.corners.lens_edges import straighten
from labcal.detect.edges.residuals import LAGS, SUMS


class Round(NamedTuple):
    """Fits of n corners.

    Attributes
    ----------
    ok : ndarray of bool, shape (n,)
        Whether each has converged where it may.
    states : ndarray, shape (n, PARAMETERS)
    rms : ndarray, shape (n,)
        Root mean square residuals.
    pixels : PackedPixels
    normals : ndarray, shape (n, ROWS, ROWS)
        Lower triangles of the normal matrices; empty where they are not kept.
    """

    ok: np.ndarray
    states: np.ndarray
    rms: np.ndarray
    pixels: PackedPixels
    normals: np.ndarray


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
    centres, axes, bends, around = places.centre, places.axes, places.bend, places.limits
    n = len(centres)
    ok, states, rms = np.zeros(n, dtype=np.bool_), np.zeros((n, PARAMETERS)), np.zeros(n)
    windows = []
    for k in range(n):
        here = WindowLimits(
            around[k, 0], around[k, 1], around[k, 2], around[k, 3], around[k, 4], around[k, 5]
        )
        ok[k], states[k], window, rms[k] = first_fit(grey, (centres[k], axes[k], bends[k]), here, limits)
        windows.append(window)
    return Round(ok, states, rms, packed(windows), np.zeros((0, ROWS, ROWS)))


@compiled
def wide_fits(
    grey: np.ndarray,
    places: Places,
    begin: tuple[np.ndarray, np.ndarray],
    limits: tuple[WiderLimits, FitLimits],
) -> Round:
    """Return the second fits of corners, from the states of the first ones (n, PARAMETERS) on.

    `begin` holds these, and the runs of the edges by a lens (n, 2, 7).
    """
    first, runs = begin
    centres, axes, bends, around = places.centre, places.axes, places.bend, places.limits
    own, newton = limits
    n = len(centres)
    ok, states, rms = np.zeros(n, dtype=np.bool_), first.copy(), np.zeros(n)
    normals = np.zeros((n, ROWS, ROWS))
    windows = []
    for k in range(n):
        here = WindowLimits(
            around[k, 0], around[k, 1], around[k, 2], around[k, 3], around[k, 4], around[k, 5]
        )
        state = states[k]
        state[:2] = 0.0
        blur, narrow = max(state[4], state[5]), narrowest(axes[k])
        guard = own.marker_guard_blurs * blur / narrow
        if not leaves_out_clipped(state, newton):
            here = with_clipped(here)
        mask, offset, value, gap = window_arrays(grey, (centres[k], axes[k]), here, guard)
        straighten(offset, runs[k])
        mask, offset, value = near_edges((mask, offset, value), state, own.edge_blurs)
        windows.append((mask, offset, value, gap))
        if len(value) < own.min_pixels:
            continue
        pixels = (offset, value, gap, bends[k], CHESSBOARD, 0.0)
        rms[k] = settled_with(state, pixels, (own.first_tolerance_px, PARAMETERS), newton, normals[k])
        ok[k] = (
            rms[k] >= 0.0
            and state[7] > 0.0
            and max(state[4], state[5]) <= own.max_blur_squares * narrow
            and state[0] ** 2 + state[1] ** 2 <= (own.max_refit_blurs * blur) ** 2
        )
    return Round(ok, states, rms, packed(windows), normals)


@compiled
def take_known_lights(states: np.ndarray, normals: np.ndarray, slopes: np.ndarray) -> None:
    """Set states (n, PARAMETERS) of fits, in place, to the least squares with known slopes of the light."""
    for k in range(len(states)):
        take_known_light(states[k], normals[k], slopes[k])


@compiled
def light_fits(
    pixels: tuple[PackedPixels, np.ndarray, np.ndarray],
    bends: np.ndarray,
    states: np.ndarray,
    limits: tuple[WiderLimits, FitLimits],
) -> np.ndarray:
    """Fit states (n, PARAMETERS), in place, with the slope of the light as they have it.

    `pixels` are those of some corners, which of them each state is of (n,), and the patterns (n,). Return the
    root mean square residuals (n,), negative where a fit does not converge.
    """
    all_, which, patterns = pixels
    own, newton = limits
    rms = np.full(len(states), -1.0)
    for k in range(len(states)):
        window = pixels_of(all_, which[k], bends[k], patterns[k], 0.0)
        if len(window[1]) >= own.min_pixels:
            rms[k] = settled(states[k], window, (own.tolerance_px, LIGHT_KNOWN), newton)
    return rms


@compiled
def judgements(
    pixels: tuple[PackedPixels, np.ndarray],
    shapes: tuple[np.ndarray, np.ndarray, np.ndarray],
    fits: tuple[np.ndarray, np.ndarray],
    limits: JudgementLimits,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return whether there are pixels enough (n,), covariances, sums, powers and reaches of fits.

    `pixels` are those of some corners, and which of them each fit is of (n,); `shapes` their patterns (n,),
    tones (n,) and bends (n, 2). `fits` holds the states (n, PARAMETERS), and how many of the parameters were
    fitted (n,).
    """
    (all_, which), (patterns, tones, bends), (states, free) = pixels, shapes, fits
    n = len(states)
    ok, reach = np.zeros(n, dtype=np.bool_), np.zeros(n)
    covariance, sums, powers = np.zeros((n, 2, 2)), np.zeros((n, LAGS, SUMS)), np.zeros((n, WAVES, 2))
    for k in range(n):
        window = pixels_of(all_, which[k], bends[k], patterns[k], tones[k])
        fine, own, products, waves, far = judged(states[k], window, mask_of(all_, which[k]), free[k], limits)
        if fine:
            ok[k], covariance[k], sums[k], powers[k], reach[k] = fine, own, products, waves, far
    return ok, covariance, sums, powers, reach
