"""Sub-pixel fit of one corner of a chessboard, by Gauss-Newton."""

from dataclasses import dataclass, replace
from math import atan2, hypot, sqrt
from typing import NamedTuple

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.corners.corner_judgement import CornerFit, JudgementLimits, judged
from labcal.detect.corners.corner_kernel import (
    CHESSBOARD,
    LIGHT_KNOWN,
    PARAMETERS,
    FitLimits,
    settled,
)
from labcal.detect.corners.corner_model import CornerPixels
from labcal.detect.corners.corner_window import (
    Surroundings,
    WindowLimits,
    narrowest,
    near_edges,
    window_arrays,
)
from labcal.detect.corners.first_state import write_first_state
from labcal.detect.grey import GreyPicture
from labcal.detect.stage_settings.corner import CornerSettings


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


@dataclass(frozen=True)
class SettledCorner:
    """A fit of one corner that has converged, without its uncertainty.

    Attributes
    ----------
    state : ndarray, shape (PARAMETERS,)
        The parameters; the corner's place is relative to `start`.
    window : CornerPixels
    start : ndarray, shape (2,)
        Where the fit began, px.
    roughness : float
        Root mean square residual over the step from black to white.
    free : int
        Number of parameters that were fitted, from the first one on; the others are taken for known.
    """

    state: np.ndarray
    window: CornerPixels
    start: np.ndarray
    roughness: float
    free: int = PARAMETERS

    @property
    def centre(self) -> np.ndarray:
        """The crossing of the edges, px."""
        return np.asarray(self.start + self.state[:2])

    @property
    def step(self) -> float:
        """From black to white, in grey values."""
        return 2.0 * float(self.state[7])


def fit_corner(grey: GreyPicture, around: Surroundings, settings: CornerSettings) -> SettledCorner | None:
    """Fit ``(1 + g d) (m + h X(u1 / s1, u2 / s2))`` to the pixels around a corner, by Gauss-Newton.

    `u1` and `u2` are the distances from the two edges, `s1` and `s2` their blurs, `d` the offset from where
    the fit begins, and ``X`` a chessboard of -1 and 1 blurred by a Gaussian: the expectation of
    ``sign(a + z1) sign(b + z2)`` for standard normal z1, z2 that are as correlated as the edges' normals.
    That is ``1 - 4 T(a, .) - 4 T(b, .)``, less 2 where a and b differ in sign, with Owen's T (Owen 1956,
    Annals of Mathematical Statistics 27). The darkness that a marker's border spreads is subtracted. Whatever
    else is not as modelled, but the same on opposite sides of the corner, does not move it.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    around : Surroundings
        Where to begin.
    settings : CornerSettings

    Returns
    -------
    SettledCorner or None
        None where the fit does not converge near the beginning, or on squares of the wrong colours.
    """
    place = (around.centre, around.axes, around.bend)
    limits = settings.limits(FirstLimits), settings.limits(FitLimits)
    ok, state, (mask, offset, value, gap), rms = _first_fit(grey, place, around.limits, limits)
    if not ok:
        return None
    window = CornerPixels(mask, offset, value, gap, CHESSBOARD, around.bend)
    return SettledCorner(state, window, around.centre, rms / (2.0 * float(state[7])))


@compiled
def _first_fit(
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
    window = window_arrays(grey, (centre, axes), around, own.marker_guard_blurs * blur / narrow)
    if len(window[2]) < own.min_pixels:
        return False, state, window, 0.0
    _begin(state, window[2], (axes, around.white, blur))
    pixels = (window[1], window[2], window[3], bend, CHESSBOARD)
    if settled(state, pixels, (own.first_tolerance_px, PARAMETERS), newton) < 0.0:
        return False, state, window, 0.0
    # What is left out around markers follows the blur, now that it is known.
    blur = max(state[4], state[5])
    window = window_arrays(grey, (centre, axes), around, own.marker_guard_blurs * blur / narrow)
    if len(window[2]) < own.min_pixels:
        return False, state, window, 0.0
    pixels = (window[1], window[2], window[3], bend, CHESSBOARD)
    rms = settled(state, pixels, (own.tolerance_px, PARAMETERS), newton)
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


def widen(
    grey: GreyPicture, around: Surroundings, first: np.ndarray, settings: CornerSettings
) -> SettledCorner | None:
    """Fit the same to other pixels, those along the edges, from the state of a first fit on.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    around : Surroundings
        With the corner of the first fit as its centre.
    first : ndarray, shape (PARAMETERS,)
        The first fit's state.
    settings : CornerSettings

    Returns
    -------
    SettledCorner or None
        None where the fit leaves the first one by more than either may be off.
    """
    state = first.copy()
    state[:2] = 0.0
    blur, narrow = max(float(first[4]), float(first[5])), narrowest(around.axes)
    guard = settings.marker_guard_blurs * blur / narrow
    mask, offset, value, gap = window_arrays(grey, (around.centre, around.axes), around.limits, guard)
    mask, offset, value = near_edges((mask, offset, value), state, settings.edge_blurs)
    window = CornerPixels(mask, offset, value, gap, CHESSBOARD, around.bend)
    rms = settle(state, window, settings.first_tolerance_px, settings)
    if rms < 0.0:
        return None
    x, y, _, _, blur_1, blur_2, _, half, _, _ = state.tolist()
    if half <= 0 or max(blur_1, blur_2) > settings.max_blur_squares * narrow:
        return None
    if hypot(x, y) > settings.max_refit_blurs * blur:
        return None
    return SettledCorner(state, window, around.centre, rms / (2.0 * half))


def with_known_light(
    wide: SettledCorner, slope: np.ndarray, bend: np.ndarray, settings: CornerSettings
) -> SettledCorner | None:
    """Return a wide fit with the slope of the light and the bend of its edges as they are known.

    Parameters
    ----------
    wide : SettledCorner
    slope : ndarray, shape (2,)
        At the corner.
    bend : ndarray, shape (2,)
    settings : CornerSettings

    Returns
    -------
    SettledCorner or None
        None where it does not converge.
    """
    state = wide.state.copy()
    # The model's light is 1 where the fit began: the slope at the corner is over the level there.
    state[8:] = slope / (1.0 - slope @ state[:2])
    window = replace(wide.window, bend=bend)
    rms = settle(state, window, settings.tolerance_px, settings, LIGHT_KNOWN)
    if rms < 0.0 or state[7] <= 0:
        return None
    return SettledCorner(state, window, wide.start, rms / (2.0 * float(state[7])), LIGHT_KNOWN)


def is_cut(place: np.ndarray, grey: GreyPicture, margin: float) -> bool:
    """Tell whether the frame is nearer to a corner than a margin (px), or leaves nothing of it."""
    last = np.array(grey.shape[::-1]) - 1
    return bool((place < margin).any() or (place > last - margin).any())


def settle(
    state: np.ndarray,
    window: CornerPixels,
    tolerance: float,
    settings: CornerSettings,
    free: int = PARAMETERS,
) -> float:
    """Iterate a state, in place, to the least squares; return the residuals' root mean square, or -1.

    -1 is returned where there are too few pixels, or the state runs away.
    """
    if len(window.value) < settings.min_pixels:
        return -1.0
    return settled(state, window.arrays, (tolerance, free), settings.limits(FitLimits))


def judge(fit: SettledCorner, settings: CornerSettings) -> CornerFit | None:
    """Return a fit with its uncertainty; None where there are too few pixels for one."""
    ok, covariance, sums, powers, reach = judged(
        fit.state, fit.window.arrays, fit.window.mask, fit.free, settings.limits(JudgementLimits)
    )
    return CornerFit(fit.centre, covariance, fit.roughness, sums, powers, reach) if ok else None
