"""Centres of a board's dots without what blur and a slope of the light together move them by."""

from dataclasses import replace

import numpy as np

from labcal.arrays import PixelCovariances, Pixels
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
_CLIPPED, _BLURS = 0.05, 2.2
"""Share of the brighter side from which on it is clipped; and blurs that an edge then moves for each factor e
of light, RMS of drawn boards whose light is 1.1 to 1.6 times the clipping value and rises by 30% across."""
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
    not tell it. The covariance stays as it is, since such a slope adds below a hundredth of it; where what is
    bright is clipped, it grows.

    Parameters
    ----------
    fits : EdgeFits
    """
    slopes = _slopes(fits)
    covariance = fits.covariance + _clipped_covariances(fits)
    return replace(fits, light_slope=slopes, centre=_lit(fits, slopes), covariance=covariance)


def _clipped_covariances(fits: EdgeFits) -> PixelCovariances:
    """Return what clipping and a slope of the light together add to covariances, px squared, shape (n, 2, 2).

    An edge whose brighter side is cut off stands further towards the dark by some blurs for each factor e
    of light, so that the outline moves along the slope of the light by that, times the radius. The slope is
    that of the darker levels of the dots around.
    """
    added = np.zeros((len(fits.ok), 2, 2))
    clipped = fits.ok & (fits.burnt > _CLIPPED)
    if not clipped.any():
        return added
    dark = np.minimum(fits.board, fits.dot)
    none = np.zeros_like(fits.light_slope)
    slopes = slopes_around(fits.ok, (dark, dark), fits.centre, (fits.blur, fits.covariance), none, _LIMITS)
    radius = np.linalg.det(fits.shape[clipped]) ** 0.25
    moved = (_BLURS * fits.blur[clipped] * radius)[:, None] * slopes[clipped]
    added[clipped] = moved[:, :, None] * moved[:, None, :]
    return added


def _slopes(fits: EdgeFits) -> Pixels:
    """Return the slopes of the light (n, 2), 1/px: of the logarithm of the brighter level of the dots around.

    Where these do not tell it, as beside the edge of a shadow, a dot has its own board's slope; where its
    board is the darker side, none.
    """
    levels, spread = (fits.board, fits.dot), (fits.blur, fits.covariance)
    return slopes_around(fits.ok, levels, fits.centre, spread, fits.light_slope, _LIMITS)
