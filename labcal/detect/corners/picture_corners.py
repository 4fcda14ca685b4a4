"""Corners of a board as the detection of a picture: places, covariances and flags."""

from collections.abc import Sequence

import numpy as np

from labcal.arrays import DotIndices, Pixels
from labcal.detect.corners.clipped_edges import with_clipped_edges
from labcal.detect.corners.corner_fit import SettledCorner, is_cut, judge_all
from labcal.detect.corners.corner_judgement import CornerFit
from labcal.detect.corners.corners import Corners, spans_a_plane
from labcal.detect.corners.edge_waves import wavelengths
from labcal.detect.corners.hard_edges import hard_edge_covariances
from labcal.detect.corners.printed_fit import PrintedCorner
from labcal.detect.dots import PictureDots
from labcal.detect.edges.noise import noise_factor
from labcal.detect.edges.outline_noise import beside_flat_parts, smooth_wave_ratio
from labcal.detect.flags import DotFlag, Refusal
from labcal.detect.grey import GreyPicture
from labcal.detect.settings import DetectSettings
from labcal.detect.stage_settings.corner import CornerSettings
from labcal.detect.stage_settings.edge import EdgeSettings
from labcal.geometry.two_by_two import eigenvalues
from labcal.targets.grid import Polarity

_SMALL = 1.25  # side of a square over that of the fewest pixels of a fit, which reaches 0.45 squares around
_PIXEL = 12**-0.5
"""Standard deviation of places within a pixel, px."""
_CERTAIN = 0.05
"""Error of a corner that is measured, however certain the others of a picture are, px."""
_SHADINGS = 1.3  # of a fit's four for the light, spent on the flat parts: a third of its pixels


def picture_corners(
    corners: Corners, grey: GreyPicture, refusal: Refusal | None, settings: DetectSettings
) -> PictureDots:
    """Return the corners of a picture, row by row, with their covariances and flags.

    A corner that is not measured is flagged ``bad-fit``, or ``cut`` at the frame; so is one whose fit has
    converged, but whose pixels hardly tell its place, as those that something leaves of a covered corner.

    Parameters
    ----------
    corners : Corners
    grey : ndarray, shape (h, w)
        The picture.
    refusal : Refusal or None
    settings : DetectSettings
    """
    corners = corners.select(np.lexsort((corners.index[:, 0], corners.index[:, 1])))
    n = len(corners.fits)
    fits = _judged(corners.fits, settings.corner)
    factor = _factor([fit for fit in fits if fit is not None], settings.edge)
    fits = _determined(fits, corners.fits, factor, settings.corner)
    position, covariance = np.full((n, 2), np.nan), np.full((n, 2, 2), np.nan)
    some = [k for k, fit in enumerate(fits) if fit is not None]
    if some:
        position[some] = [fit.centre for fit in fits if fit is not None]
        own = np.array([fit.covariance for fit in fits if fit is not None])
        covariance[some] = factor * own + _added(corners.fits, settings.corner)[some]
    dots = PictureDots(
        size=(grey.shape[1], grey.shape[0]),
        polarity=Polarity.BLACK_ON_WHITE,
        refusal=None,
        index=corners.index,
        has_id=np.ones(n, dtype=bool),
        position=position,
        covariance=covariance,
        misfit=np.full(n, np.nan),
        flag=tuple(
            DotFlag.OK
            if fit is not None
            else DotFlag.CUT
            if is_cut(place, grey, settings.corner.frame_margin_px)
            else DotFlag.BAD_FIT
            for fit, place in zip(fits, corners.seen_at, strict=True)
        ),
        seen_at=corners.seen_at,
        outline=np.full((n, 2, 2), np.nan),
    )
    dots = with_clipped_edges(dots, corners.fits, grey, settings)
    return dots if refusal is None else dots.refused(refusal)


def refused_as_torn(
    dots: PictureDots, placed: DotIndices, detail: str, settings: CornerSettings
) -> PictureDots:
    """Return the corners of a picture, refused because too few are measured: torn, or too small for a fit.

    Parameters
    ----------
    dots : PictureDots
        As of :func:`picture_corners`.
    placed : ndarray of int, shape (n, 2)
        (col, row) of the corners that are seen.
    detail : str
        What was found, for people.
    settings : CornerSettings
    """
    side = square_px(dots.index, dots.seen_at)
    if side < _SMALL * np.sqrt(settings.min_pixels):
        return dots.refused(Refusal.TOO_SMALL, f"{detail} A square is some {side:.1f} px wide.")
    return refused_as_few(dots, placed, detail)


def square_px(index: DotIndices, q: Pixels) -> float:
    """Return the usual distance of corners that are neighbours, px; infinite where there are none."""
    places = {(int(i), int(j)): k for k, (i, j) in enumerate(index)}
    pairs = [
        (k, places[i + a, j + b])
        for (i, j), k in places.items()
        for a, b in ((1, 0), (0, 1))
        if (i + a, j + b) in places
    ]
    if not pairs:
        return float("inf")
    here, there = np.array(pairs).T
    return float(np.median(np.linalg.norm(q[here] - q[there], axis=1)))


def refused_as_few(dots: PictureDots, placed: DotIndices, detail: str) -> PictureDots:
    """Return the corners of a picture, refused because too few of them are measured.

    Parameters
    ----------
    dots : PictureDots
        As of :func:`picture_corners`.
    placed : ndarray of int, shape (n, 2)
        (col, row) of the corners that markers place.
    detail : str
        What was found, for people.
    """
    whole = np.array([flag is not DotFlag.CUT for flag in dots.flag], dtype=bool)
    torn = spans_a_plane(placed) and spans_a_plane(dots.index[whole])
    return dots.refused(Refusal.TORN_CORNERS if torn else Refusal.TOO_FEW_DOTS, detail)


def _added(fits: Sequence[SettledCorner | None], settings: CornerSettings) -> np.ndarray:
    """Return the covariances of the places of fits that are not from noise, px squared, shape (n, 2, 2)."""
    added = hard_edge_covariances(fits, settings.min_blur_px)
    for k, fit in enumerate(fits):
        if isinstance(fit, PrintedCorner):
            added[k] += fit.shared
    return added


def _judged(fits: Sequence[SettledCorner | None], settings: CornerSettings) -> list[CornerFit | None]:
    """Return fits of either kind with their uncertainties; None for none."""
    plain = judge_all([None if isinstance(fit, PrintedCorner) else fit for fit in fits], settings)
    return [
        fit.judged(settings) if isinstance(fit, PrintedCorner) else one
        for fit, one in zip(fits, plain, strict=True)
    ]


def _determined(
    fits: Sequence[CornerFit | None],
    settled: Sequence[SettledCorner | None],
    factor: float,
    settings: CornerSettings,
) -> list[CornerFit | None]:
    """Return fits, but None where the pixels hardly tell the corner's place.

    An error near the width of an edge is not as the covariance has it, since the fit is not linear there; and
    a corner that is far less certain than the others is seen by a small part of its edges.
    """
    found = list(fits)
    rows = [
        (k, fit.covariance, max(of.state[4:6].tolist()))
        for k, (fit, of) in enumerate(zip(fits, settled, strict=True))
        if fit is not None and of is not None
    ]
    if not rows:
        return found
    numbers, covariances, blurs = zip(*rows, strict=True)
    error = np.sqrt(factor * eigenvalues(np.array(covariances))[:, 1])
    width = np.hypot(blurs, _PIXEL)
    usual = max(settings.max_error_factor * float(np.median(error)), _CERTAIN)
    uncertain = ~(error <= np.minimum(settings.max_error_blurs * width, usual))
    for k, is_uncertain in zip(numbers, uncertain.tolist(), strict=True):
        found[k] = None if is_uncertain else found[k]
    return found


def _factor(fits: list[CornerFit], settings: EdgeSettings) -> float:
    """Return the variance of a picture's corners over what the residuals of their fits say."""
    if not fits:
        return 1.0
    flat = noise_factor(np.array([fit.sums for fit in fits]), settings, _SHADINGS)
    waves = wavelengths(float(np.median([fit.reach for fit in fits])))
    ratio, error = smooth_wave_ratio(np.array([fit.powers for fit in fits]), waves, settings)
    return beside_flat_parts(ratio, error, flat, settings)
