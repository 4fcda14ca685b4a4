"""Centres of a board's dots without what blur and a slope of the light together move them by."""

from dataclasses import replace

import numpy as np

from labcal.arrays import Pixels
from labcal.detect.edge_fit import EdgeFits
from labcal.detect.nearest_planes import nearest_planes

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
    return np.asarray(fits.centre + (fits.blur**2)[:, None] * fits.light_slope)


def in_falling_light(fits: EdgeFits) -> EdgeFits:
    """Return the fits of one board's dots with :func:`lit_centres` and the slopes of the light of them all.

    What is bright of a print, be it the board or its dots, is alike everywhere: the levels of the dots around
    tell the slope of the light far better than the dot's own pixels do, and where the board is dark these do
    not tell it. The covariance stays as it is, since such a slope adds below a hundredth of it.

    Parameters
    ----------
    fits : EdgeFits
    """
    lit = replace(fits, light_slope=_slopes(fits))
    return replace(lit, centre=lit_centres(lit))


def _slopes(fits: EdgeFits) -> Pixels:
    """Return the slopes of the light (n, 2), 1/px: of the logarithm of the brighter level of the dots around.

    Where these do not tell it, as beside the edge of a shadow, a dot has its own board's slope; where its
    board is the darker side, none.
    """
    own_tells = ~fits.ok | (np.nan_to_num(fits.board) > np.nan_to_num(fits.dot))
    slopes = np.where(own_tells[:, None], fits.light_slope, 0.0)
    some = np.flatnonzero(fits.ok)
    if len(some) < _FEWEST:
        return slopes
    place = fits.centre[some]
    level = np.log(np.maximum(np.maximum(fits.board, fits.dot)[some], _DARKEST))
    around, variance = nearest_planes(place, level, min(_NEIGHBOURS + 1, len(some)), _MOST_OBLONG)
    added = fits.blur[some] ** 4 * variance
    tells = added < _MOST_ADDED * (fits.covariance[some, 0, 0] + fits.covariance[some, 1, 1])
    slopes[some[tells]] = around[tells]
    return slopes
