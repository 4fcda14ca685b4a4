"""Fit of a corner of a ChArUco board by all of the print around it: edges of squares and cells of markers."""

from dataclasses import dataclass, field

import numpy as np

from labcal.detect.corners.corner_fit import SettledCorner
from labcal.detect.corners.corner_judgement import CornerFit, JudgementLimits, judged_rows
from labcal.detect.corners.corner_kernel import PARAMETERS, FitLimits
from labcal.detect.corners.corner_model import CornerPixels
from labcal.detect.corners.lens_maps import moved_beyond
from labcal.detect.corners.printed_kernel import (
    FREE,
    ROWS,
    PrintLines,
    empty_rows,
    fill_printed,
    settled_print,
)
from labcal.detect.corners.printed_place import LocalMap
from labcal.detect.corners.printed_window import print_pixels
from labcal.detect.corners.uncovered import noise_around, uncovered
from labcal.detect.grey import GreyPicture
from labcal.detect.row_products import filled_up
from labcal.detect.stage_settings.corner import CornerSettings

_NO_GAP = np.full(2, 1e6)
_LEAST_SEEN = 0.25
"""Of the pixels around a corner, that nothing covers, for a fit by these."""
_LEAST_NOISE = 0.1
"""Of a pixel, grey values: in drawings there is none, but a rounding."""


@dataclass(frozen=True, kw_only=True)
class PrintedCorner(SettledCorner):
    """A fit of a corner by all of the print around it.

    Attributes
    ----------
    around : LocalMap
    print_ : PrintLines
    prior : ndarray, shape (FREE, FREE)
        Information on the fit's parameters from the corners around, over that of a pixel.
    sigma : float
        Error of its place along either axis, px, for noise alone; infinite if unknown.
    whole : bool
        True if no pixels around it were left out as covered.
    shared : ndarray, shape (2, 2)
        Covariance of its place by what all corners of a board share, px squared.
    """

    around: LocalMap
    print_: PrintLines
    prior: np.ndarray
    sigma: float = np.inf
    whole: bool = True
    shared: np.ndarray = field(default_factory=lambda: np.zeros((2, 2)))

    def judged(self, settings: CornerSettings) -> CornerFit | None:
        """Return the fit with its uncertainty; None where there are too few pixels for one."""
        pixels = np.ascontiguousarray(self.window.offset), self.window.value
        n = len(pixels[1])
        table, board, off_edges = np.zeros((ROWS, filled_up(n))), np.empty(n), np.empty(n)
        rows = table[FREE], table[:FREE], board, off_edges
        fill_printed(self.state, pixels, self.around, self.print_, rows)
        away = pixels[0] - self.state[:2, None]
        ok, covariance, sums, powers, reach = judged_rows(
            (table, board, off_edges), away, self.window.mask, self.prior, settings.limits(JudgementLimits)
        )
        return CornerFit(self.centre, covariance, self.roughness, sums, powers, reach) if ok else None


def fit_print(
    grey: GreyPicture,
    first: SettledCorner,
    place: tuple[LocalMap, np.ndarray, np.ndarray],
    print_: tuple[PrintLines, float],
    settings: CornerSettings,
    roughest: float = np.inf,
) -> PrintedCorner | None:
    """Fit ``(1 + g d) (m + h X)`` to all pixels nearer to a corner than to the next ones, by Gauss-Newton.

    ``X`` is the print between -1 (black) and 1, blurred by a Gaussian with a deviation across either edge, as
    the map from the corners around shows it. Free are the corner, both deviations, `m` and `h`, and the map,
    as far as the corners around leave it so; the slope `g` of the light is known.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    first : SettledCorner
        A fit that is near, with the slope of the light.
    place : (LocalMap, ndarray, ndarray)
        The map, the information on it (10, 10), and what a lens adds to it (2, 11).
    print_ : (PrintLines, float)
        And the c of its :mod:`~labcal.detect.corners.tone_curve`.
    settings : CornerSettings
    roughest : float
        Noise over the step, beyond which pixels are taken for covered and left out.

    Returns
    -------
    PrintedCorner or None
        None where the fit leaves the first one by more than either may be off.
    """
    around, (lines, tone) = LocalMap(*(part.copy() for part in place[0])), print_
    centre, M = np.ascontiguousarray(first.centre), around.linear
    mask, offset, value = print_pixels(
        grey, centre, around, (settings.wide_reach_squares, settings.max_reach_px)
    )
    if place[2].any():
        offset = moved_beyond(offset, place[2])
    state = np.concatenate([np.zeros(2), np.arctan2(M[:, 1], M[:, 0]), first.state[4:PARAMETERS], [tone]])
    whole = roughest == np.inf
    if not whole:
        rows = empty_rows(len(value))
        fill_printed(state, (offset, value), around, lines, rows)
        n, least = len(value), max(roughest * first.step, _LEAST_NOISE)
        residual = rows[0][:n]
        noises = noise_around(residual, rows[2][:n], least)
        seen = uncovered(mask, residual, noises, float(state[4:6].max()))
        if seen.mean() < _LEAST_SEEN:
            return None
        mask[mask] = seen
        offset, value = np.ascontiguousarray(offset[:, seen]), value[seen]
    if len(value) < settings.min_pixels:
        return None
    prior = np.zeros((FREE, FREE))
    noise = max(first.roughness * first.step, _LEAST_NOISE)
    prior[-len(place[1]) :, -len(place[1]) :] = noise**2 * place[1]
    limits = settings.limits(FitLimits), settings.limits(JudgementLimits)
    rms, sigma = settled_print(state, (offset, value), (around, lines, prior), settings.tolerance_px, limits)
    if rms < 0.0 or state[7] <= 0.0:
        return None
    blur = float(first.state[4:6].max())
    if float(np.hypot(*state[:2])) > settings.max_refit_blurs * blur:
        return None
    window = CornerPixels(mask, offset, value, _NO_GAP)
    roughness = rms / (2.0 * float(state[7]))
    return PrintedCorner(
        state,
        window,
        centre,
        roughness,
        FREE,
        around=around,
        print_=lines,
        prior=prior,
        sigma=sigma,
        whole=whole,
    )
