"""First fit of a corner of a chessboard, in compiled code."""

from math import atan2, hypot, sqrt
from typing import NamedTuple

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.corners.corner_kernel import CHESSBOARD, PARAMETERS, FitLimits, settled
from labcal.detect.corners.corner_window import WindowLimits, narrowest, window_arrays, with_clipped
from labcal.detect.corners.first_state import write_first_state

_WIDE_BLURS = 1.2
"""Blur of edges that show how they go on to white, over the least one."""


class FirstLimits(NamedTuple):
    """The settings of corners that a first fit takes, besides those of Gauss-Newton."""

    first_blur_px: float
    first_tolerance_px: float
    tolerance_px: float
    marker_guard_blurs: float
    min_pixels: int
    max_blur_squares: float
    max_move_squares: float
    frame_margin_px: float


@compiled
def first_fit(
    grey: np.ndarray,
    place: tuple[np.ndarray, np.ndarray, np.ndarray],
    around: WindowLimits,
    limits: tuple[FirstLimits, FitLimits],
) -> tuple[bool, np.ndarray, tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray], float]:
    """Return whether a fit converges near its beginning; its state, window and root mean square residual.

    `place` holds the corner's centre, its axes, and the bend of its edges.
    """
    centre, axes, bend = place
    own, newton = limits
    narrow, state = narrowest(axes), np.zeros(PARAMETERS)
    blur = own.first_blur_px
    whole = with_clipped(around)
    window = window_arrays(grey, (centre, axes), whole, own.marker_guard_blurs * blur / narrow)
    if len(window[2]) < own.min_pixels:
        return False, state, window, 0.0
    _begin(state, window[2], (axes, around.white, blur))
    pixels = (window[1], window[2], window[3], bend, CHESSBOARD, 0.0)
    if settled(state, pixels, (own.first_tolerance_px, PARAMETERS), newton) < 0.0:
        return False, state, window, 0.0
    # What is left out around markers follows the blur, now that it is known.
    blur = max(state[4], state[5])
    guard, begun = own.marker_guard_blurs * blur / narrow, state.copy()
    is_wide = leaves_out_clipped(state, newton)
    window = window_arrays(grey, (centre, axes), around if is_wide else whole, guard)
    rms = _settled_in(state, window, bend, (own.min_pixels, own.tolerance_px), newton)
    if is_wide and (rms < 0.0 or not leaves_out_clipped(state, newton)):
        # The beginning was rougher than the edges: those without blur are fitted with what is clipped.
        state[:] = begun
        window = window_arrays(grey, (centre, axes), whole, guard)
        rms = _settled_in(state, window, bend, (own.min_pixels, own.tolerance_px), newton)
        if leaves_out_clipped(state, newton):
            return False, state, window, 0.0
    if rms < 0.0:
        return False, state, window, 0.0
    square = sqrt(abs(axes[0, 0] * axes[1, 1] - axes[0, 1] * axes[1, 0]))
    x, y, margin = centre[0] + state[0], centre[1] + state[1], own.frame_margin_px
    ok = (
        state[7] > 0.0
        and max(state[4], state[5]) <= own.max_blur_squares * narrow
        and hypot(state[0], state[1]) <= min(own.max_move_squares * square, around.reach)
        and min(x, y) >= margin
        and x <= grey.shape[1] - 1 - margin
        and y <= grey.shape[0] - 1 - margin
    )
    return ok, state, window, rms


@compiled
def _settled_in(
    state: np.ndarray,
    window: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray],
    bend: np.ndarray,
    least: tuple[int, float],
    newton: FitLimits,
) -> float:
    """Return the root mean square residual of a fit to a window's pixels, its state in place; -1 if none.

    `least` holds the fewest pixels and the tolerance, px.
    """
    min_pixels, tolerance_px = least
    if len(window[2]) < min_pixels:
        return -1.0
    pixels = (window[1], window[2], window[3], bend, CHESSBOARD, 0.0)
    rms: float = settled(state, pixels, (tolerance_px, PARAMETERS), newton)
    return rms


@compiled
def leaves_out_clipped(state: np.ndarray, limits: FitLimits) -> bool:
    """Tell whether edges are wide enough to be fitted without the white beyond, where that is clipped.

    Edges without blur, as in drawings, are nothing but black and clipped white.
    """
    return bool(min(state[4], state[5]) > _WIDE_BLURS * limits.min_blur_px)


@compiled
def _begin(state: np.ndarray, value: np.ndarray, first: tuple[np.ndarray, float, float]) -> None:
    """Write first parameters; the normals are those of the board's axes, so that the step is positive.

    `first` holds the axes, the colour of the upper right square, and a blur.
    """
    axes, white, blur = first
    ax, ay, bx, by = axes[0, 0], axes[1, 0], axes[0, 1], axes[1, 1]
    # The edge along y separates left from right: its normal points to the board's right; likewise the other.
    right = 1.0 if bx * ay - by * ax > 0.0 else -1.0
    up = white if ay * bx - ax * by > 0.0 else -white
    write_first_state(state, (atan2(right * bx, -right * by), atan2(-up * ax, up * ay)), value, blur)
