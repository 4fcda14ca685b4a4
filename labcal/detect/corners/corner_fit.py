"""Sub-pixel fits of the corners of a chessboard, by Gauss-Newton."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from labcal.detect.corners.corner_judgement import CornerFit, JudgementLimits, judged
from labcal.detect.corners.corner_kernel import CHESSBOARD, LIGHT_KNOWN, PARAMETERS, FitLimits, settled
from labcal.detect.corners.corner_model import CornerPixels
from labcal.detect.corners.corner_pixels import pack, unpacked
from labcal.detect.corners.corner_rounds import (
    Places,
    Round,
    WiderLimits,
    first_fits,
    judgements,
    light_fits,
    wide_fits,
)
from labcal.detect.corners.corner_window import Surroundings
from labcal.detect.corners.first_fit import FirstLimits
from labcal.detect.grey import GreyPicture
from labcal.detect.stage_settings.corner import CornerSettings


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
    """Fit one corner, see :func:`fit_corners`."""
    return fit_corners(grey, [around], settings)[0]


def fit_corners(
    grey: GreyPicture, around: Sequence[Surroundings], settings: CornerSettings
) -> list[SettledCorner | None]:
    """Fit ``(1 + g d) (m + h X(u1 / s1, u2 / s2))`` to the pixels around each corner, by Gauss-Newton.

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
    around : sequence of Surroundings
        Where to begin.
    settings : CornerSettings

    Returns
    -------
    list of SettledCorner or None
        None where the fit does not converge near the beginning, or on squares of the wrong colours.
    """
    if not around:
        return []
    limits = settings.limits(FirstLimits), settings.limits(FitLimits)
    return _settled_corners(first_fits(grey, _places(around), limits), around)


def widen(
    grey: GreyPicture, around: Sequence[Surroundings], first: np.ndarray, settings: CornerSettings
) -> list[SettledCorner | None]:
    """Fit the same to other pixels, those along the edges, from the states of first fits on.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    around : sequence of Surroundings
        With the corners of the first fits as their centres.
    first : ndarray, shape (n, PARAMETERS)
        The first fits' states.
    settings : CornerSettings

    Returns
    -------
    list of SettledCorner or None
        None where the fit leaves the first one by more than either may be off.
    """
    if not around:
        return []
    limits = settings.limits(WiderLimits), settings.limits(FitLimits)
    return _settled_corners(wide_fits(grey, _places(around), first, limits), around)


def with_known_light(
    wide: Sequence[SettledCorner], slopes: np.ndarray, bends: np.ndarray, settings: CornerSettings
) -> list[SettledCorner | None]:
    """Return wide fits with the slope of the light and the bend of their edges as they are known.

    Parameters
    ----------
    wide : sequence of SettledCorner
    slopes : ndarray, shape (n, 2)
        At the corners.
    bends : ndarray, shape (n, 2)
    settings : CornerSettings

    Returns
    -------
    list of SettledCorner or None
        None where it does not converge.
    """
    if not wide:
        return []
    windows = [one.window for one in wide]
    states = np.array([one.state for one in wide])
    # The model's light is 1 where the fit began: the slope at the corner is over the level there.
    states[:, 8:] = slopes / (1.0 - (slopes * states[:, :2]).sum(axis=1))[:, None]
    patterns = np.array([window.pattern for window in windows])
    limits = settings.limits(WiderLimits), settings.limits(FitLimits)
    rms = light_fits(pack(windows), patterns, bends, states, limits).tolist()
    found: list[SettledCorner | None] = []
    for one, state, bend, left in zip(wide, states, bends, rms, strict=True):
        step = 2.0 * float(state[7])
        if left < 0.0 or step <= 0.0:
            found.append(None)
            continue
        old = one.window
        window = CornerPixels(old.mask, old.offset, old.value, old.gap, old.pattern, bend)
        found.append(SettledCorner(state, window, one.start, left / step, LIGHT_KNOWN))
    return found


def _places(around: Sequence[Surroundings]) -> Places:
    """Return the surroundings of corners as arrays."""
    return (
        np.array([one.centre for one in around], dtype=np.float64),
        np.array([one.axes for one in around], dtype=np.float64),
        np.array([one.bend for one in around], dtype=np.float64),
        np.array([one.limits for one in around], dtype=np.float64),
    )


def _settled_corners(fits: Round, around: Sequence[Surroundings]) -> list[SettledCorner | None]:
    """Return the fits of a round; None for those that are none."""
    ok, states, rms, pixels = fits
    return [
        SettledCorner(state, CornerPixels(*window, CHESSBOARD, one.bend), one.centre, left / (2.0 * half))
        if fine
        else None
        for fine, state, half, left, window, one in zip(
            ok.tolist(), states, states[:, 7].tolist(), rms.tolist(), unpacked(pixels), around, strict=True
        )
    ]


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


def judge_all(
    fits: Sequence[SettledCorner | None], settings: CornerSettings
) -> list[CornerFit | None]:
    """Return fits with their uncertainties, as :func:`judge` does each; None for none."""
    some = [fit for fit in fits if fit is not None]
    if not some:
        return [None] * len(fits)
    windows = [fit.window for fit in some]
    states, free = np.array([fit.state for fit in some]), np.array([fit.free for fit in some])
    patterns, bends = np.array([one.pattern for one in windows]), np.array([one.bend for one in windows])
    limits = settings.limits(JudgementLimits)
    ok, *parts = judgements(pack(windows), patterns, bends, (states, free), limits)
    judged_ = iter(zip(some, ok.tolist(), *parts, strict=True))
    found: list[CornerFit | None] = []
    for fit in fits:
        if fit is None:
            found.append(None)
            continue
        one, fine, covariance, sums, powers, reach = next(judged_)
        result = CornerFit(one.centre, covariance, one.roughness, sums, powers, float(reach))
        found.append(result if fine else None)
    return found
