"""Centres of a board's dots without what blur and a slope of the light together move them by."""

from dataclasses import replace

import numpy as np

from labcal.arrays import Pixels
from labcal.detect.edge_fit import EdgeFits
from labcal.detect.slopes_around import AroundLimits, slopes_around

_NEIGHBOURS = 12
"""Dots around a dot whose levels tell the slope of the light there: those within two pitches of a grid."""
_FEWEST = 5
"""Fewer dots may be on one line."""
_MOST_OBLONG = 1e-3
"""Least over largest mean square of the distances; dots nearer to one line do not tell a slope across it."""
_MOST_ADDED = 0.0025
"""Variance that the slope may add to a centre, over the centre's: where light falls in a step, the scatter of
the levels about a plane is large."""
_DARKEST = 1e-6
"""Of a level, grey values."""
_LIMITS = AroundLimits(_NEIGHBOURS + 1, _FEWEST, _MOST_OBLONG, _MOST_ADDED, _DARKEST)


def lit_centres(fits: EdgeFits) -> Pixels:
    """Return the centres of fits without what blur and the slope of the light together move them by.

    Parameters
    ----------
    fits : EdgeFits

    Returns
    -------
    ndarray, shape (n, 2)
        Centres, px; NaN where there is no fit.

    Notes
    -----
    Blur acts on what is seen, light times print. A step whose height grows by a share g a px is blurred to a
    step that stands by g times the variance of the blur further towards the dark, all around the dot.
    """
    return _lit(fits, fits.light_slope)


def _lit(fits: EdgeFits, slopes: Pixels) -> Pixels:
    """Return the centres of fits where the light has these slopes, 1/px."""
    return np.asarray(fits.centre + (fits.blur**2)[:, None] * slopes)


def in_falling_light(fits: EdgeFits) -> EdgeFits:
    """Return the fits of one board's dots with :func:`lit_centres` and the slopes of the light of them all.

    What is bright of a print, be it the board or its dots, is alike everywhere: the levels of the dots around
    tell the slope of the light far better than the dot's own pixels do, and where the board is dark these do
    not tell it. The covariance stays as it is, since such a slope adds below a hundredth of it.

    Parameters
    ----------
    fits : EdgeFits
    """
    slopes = _slopes(fits)
    return replace(fits, light_slope=slopes, centre=_lit(fits, slopes))


def _slopes(fits: EdgeFits) -> Pixels:
    """Return the slopes of the light (n, 2), 1/px: of the logarithm of the brighter level of the dots around.

    Where these do not tell it, as beside the edge of a shadow, a dot has its own board's slope; where its
    board is the darker side, none.
    """
    levels, spread = (fits.board, fits.dot), (fits.blur, fits.covariance)
    return slopes_around(fits.ok, levels, fits.centre, spread, fits.light_slope, _LIMITS)
