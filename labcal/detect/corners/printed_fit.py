"""Fit of a corner of a ChArUco board by all of the print around it: edges of squares and cells of markers."""

from dataclasses import dataclass

import numpy as np

from labcal.detect.corners.corner_fit import SettledCorner
from labcal.detect.corners.corner_judgement import CornerFit, JudgementLimits, judged_rows
from labcal.detect.corners.corner_kernel import PARAMETERS, FitLimits
from labcal.detect.corners.corner_model import CornerPixels
from labcal.detect.corners.printed_kernel import (
    FREE,
    LocalMap,
    PrintLines,
    empty_rows,
    fill_printed,
    print_pixels,
    settled_print,
)
from labcal.detect.grey import GreyPicture
from labcal.detect.stage_settings.corner import CornerSettings

_NO_GAP = np.full(2, 1e6)


@dataclass(frozen=True)
class PrintedCorner(SettledCorner):
    """A fit of a corner by all of the print around it.

    Attributes
    ----------
    around : LocalMap
    print_ : PrintLines
    added : ndarray, shape (2, 2)
        Covariance of its place by that of the map around it, over the variance of the corners around.
    """

    around: LocalMap = None  # type: ignore[assignment]
    print_: PrintLines = None  # type: ignore[assignment]

    def judged(self, settings: CornerSettings) -> CornerFit | None:
        """Return the fit with its uncertainty; None where there are too few pixels for one."""
        pixels = np.ascontiguousarray(self.window.offset), self.window.value
        rows = empty_rows(len(pixels[1]))
        fill_printed(self.state, pixels, self.around, self.print_, rows)
        ok, covariance, sums, powers, reach = judged_rows(
            rows[:4], pixels[0] - self.state[:2, None], self.window.mask, FREE, settings.limits(JudgementLimits)
        )
        return CornerFit(self.centre, covariance, self.roughness, sums, powers, reach) if ok else None


def fit_print(
    grey: GreyPicture,
    first: SettledCorner,
    place: tuple[LocalMap, PrintLines],
    slope: np.ndarray,
    settings: CornerSettings,
) -> PrintedCorner | None:
    """Fit ``(1 + g d) (m + h X)`` to all pixels nearer to a corner than to the next ones, by Gauss-Newton.

    ``X`` is the print between -1 (black) and 1, blurred by a Gaussian with a deviation across either edge, as
    the map from the corners around shows it. Free are the corner, both deviations, `m` and `h`; the slope
    `g` of the light is known.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    first : SettledCorner
        A fit that is near.
    place : (LocalMap, PrintLines)
    slope : ndarray, shape (2,)
        1/px.
    settings : CornerSettings

    Returns
    -------
    PrintedCorner or None
        None where the fit leaves the first one by more than either may be off.
    """
    around, print_ = place
    centre, M = np.ascontiguousarray(first.centre), around.linear
    mask, offset, value = print_pixels(
        grey, centre, around, (settings.wide_reach_squares, settings.max_reach_px)
    )
    if len(value) < settings.min_pixels:
        return None
    state = np.zeros(PARAMETERS)
    state[2:4] = np.arctan2(M[:, 1], M[:, 0])
    state[4:8], state[8:] = first.state[4:8], slope
    rms, _ = settled_print(state, (offset, value), place, settings.tolerance_px, settings.limits(FitLimits))
    if rms < 0.0 or state[7] <= 0.0:
        return None
    blur = float(first.state[4:6].max())
    if float(np.hypot(*state[:2])) > settings.max_refit_blurs * blur:
        return None
    window = CornerPixels(mask, offset, value, _NO_GAP)
    return PrintedCorner(
        state, window, centre, rms / (2.0 * float(state[7])), FREE, around=around, print_=print_
    )
