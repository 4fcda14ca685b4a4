"""Sub-pixel fits of the corners of a chessboard, by Gauss-Newton."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from labcal.detect.corners.corner_judgement import CornerFit, JudgementLimits, judged
from labcal.detect.corners.corner_kernel import CHESSBOARD, LIGHT_KNOWN, PARAMETERS, FitLimits, settled
from labcal.detect.corners.corner_model import CornerPixels
from labcal.detect.corners.corner_pixels import PackedCorner, pack
from labcal.detect.corners.corner_rounds import (
    Round,
    WiderLimits,
    first_fits,
    judgements,
    light_fits,
    take_known_lights,
    wide_fits,
)
from labcal.detect.corners.corner_window import Places, Surroundings
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
    pixels : CornerPixels or PackedCorner
    start : ndarray, shape (2,)
        Where the fit began, px.
    roughness : float
        Root mean square residual over the step from black to white.
    free : int
        Number of parameters that were fitted, from the first one on; the others are taken for known.
    """

    state: np.ndarray
    pixels: CornerPixels | PackedCorner
    start: np.ndarray
    roughness: float
    free: int = PARAMETERS

    @property
    def window(self) -> CornerPixels:
        """The pixels of the fit."""
        return self.pixels if isinstance(self.pixels, CornerPixels) else self.pixels.unpacked()

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
    return fit_corners(grey, Places.of(around), settings)[0]


def fit_corners(grey: GreyPicture, places: Places, settings: CornerSettings) -> list[SettledCorner | None]:
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
    places : Places
        Where to begin.
    settings : CornerSettings

    Returns
    -------
    list of SettledCorner or None
        None where the fit does not converge near the beginning, or on squares of the wrong colours.
    """
    if len(places.centre) == 0:
        return []
    limits = settings.limits(FirstLimits), settings.limits(FitLimits)
    fits = first_fits(grey, places, limits)
    return _settled_corners(fits, range(len(fits.ok)), places, PARAMETERS)


def widen(
    grey: GreyPicture, places: Places, begin: tuple[np.ndarray, np.ndarray], settings: CornerSettings
) -> Round:
    """Fit the same to other pixels, those along the edges, from the states of first fits on.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    places : Places
        With the corners of the first fits as their centres.
    begin : (ndarray, ndarray)
        The first fits' states (n, PARAMETERS), and the runs of the edges by a lens (n, 2, 7), see
        :func:`~labcal.detect.corners.lens_edges.edge_runs`.
    settings : CornerSettings

    Returns
    -------
    Round
        A fit that leaves the first one by more than either may be off is none.
    """
    return wide_fits(grey, places, begin, (settings.limits(WiderLimits), settings.limits(FitLimits)))


def widened_with_light(
    wide: Round, which: np.ndarray, places: Places, slopes: np.ndarray, settings: CornerSettings
) -> list[SettledCorner | None]:
    """Return some of the fits of a round, by number, with the slope of the light as it is known.

    Parameters
    ----------
    wide : Round
        Of :func:`widen`.
    which : ndarray of int, shape (n,)
    places : Places
        Of these corners, with the bends of their edges as they are known.
    slopes : ndarray, shape (n, 2)
        At the corners.
    settings : CornerSettings

    Returns
    -------
    list of SettledCorner or None
        None where it does not converge.
    """
    states, bends = wide.states[which], places.bend
    lights = _lights(states, slopes)
    take_known_lights(states, wide.normals[which], lights)
    states[:, LIGHT_KNOWN:] = lights
    limits = settings.limits(WiderLimits), settings.limits(FitLimits)
    patterns = np.full(len(which), CHESSBOARD)
    rms = light_fits((wide.pixels, which, patterns), bends, states, limits)
    fits = Round((rms >= 0.0) & (states[:, 7] > 0.0), states, rms, wide.pixels, wide.normals)
    return _settled_corners(fits, which.tolist(), places, LIGHT_KNOWN)


def _lights(states: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """Return the slopes of the light as states have them: their light is 1 where the fit began."""
    return np.asarray(slopes / (1.0 - (slopes * states[:, :2]).sum(axis=1))[:, None])


def _settled_corners(
    fits: Round, which: Sequence[int], places: Places, free: int
) -> list[SettledCorner | None]:
    """Return the fits of a round, to pixels of the corners by these numbers; None for those that are none."""
    roughness = (fits.rms / (2.0 * np.where(fits.ok, fits.states[:, 7], 1.0))).tolist()
    rows = zip(which, fits.ok.tolist(), fits.states, roughness, places.centre, places.bend, strict=True)
    return [
        SettledCorner(state, PackedCorner(fits.pixels, number, bend), start, rough, free) if fine else None
        for number, fine, state, rough, start, bend in rows
    ]


def centres_of(fits: Sequence[SettledCorner]) -> np.ndarray:
    """Return the centres of fits, px, shape (n, 2)."""
    if not fits:
        return np.zeros((0, 2))
    moved = np.array([fit.state for fit in fits])[:, :2]
    return np.asarray(np.array([fit.start for fit in fits]) + moved)


def places_of(fits: Sequence[SettledCorner | None], otherwise: np.ndarray) -> np.ndarray:
    """Return the centres of fits, px, shape (n, 2); where there is none, the place in `otherwise` (n, 2)."""
    places, some = otherwise.copy(), [k for k, fit in enumerate(fits) if fit is not None]
    places[some] = centres_of([fit for fit in fits if fit is not None])
    return places


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


def judge_all(fits: Sequence[SettledCorner | None], settings: CornerSettings) -> list[CornerFit | None]:
    """Return fits with their uncertainties, as :func:`judge` does each; None for none."""
    found: list[CornerFit | None] = [None] * len(fits)
    sources: dict[int, list[int]] = {}
    for number, fit in enumerate(fits):
        if fit is not None:
            source = id(fit.pixels.all_) if isinstance(fit.pixels, PackedCorner) else 0
            sources.setdefault(source, []).append(number)
    for numbers in sources.values():
        some = [fit for fit in (fits[number] for number in numbers) if fit is not None]
        for number, one in zip(numbers, _judged_together(some, settings), strict=True):
            found[number] = one
    return found


def _judged_together(fits: list[SettledCorner], settings: CornerSettings) -> list[CornerFit | None]:
    """Return fits to pixels of one source with their uncertainties."""
    pixels = [fit.pixels for fit in fits]
    packed = [one for one in pixels if isinstance(one, PackedCorner)]
    if packed:
        all_, which = packed[0].all_, np.array([one.number for one in packed])
    else:
        all_, which = pack([fit.window for fit in fits]), np.arange(len(fits))
    states, free = np.array([fit.state for fit in fits]), np.array([fit.free for fit in fits])
    patterns, tones = np.array([one.pattern for one in pixels]), np.array([one.tone for one in pixels])
    bends = np.array([one.bend for one in pixels])
    limits = settings.limits(JudgementLimits)
    ok, *parts = judgements((all_, which), (patterns, tones, bends), (states, free), limits)
    rows = zip(fits, ok.tolist(), centres_of(fits), *parts[:-1], parts[-1].tolist(), strict=True)
    return [
        CornerFit(centre, covariance, fit.roughness, sums, powers, reach) if fine else None
        for fit, fine, centre, covariance, sums, powers, reach in rows
    ]
