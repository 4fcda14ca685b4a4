"""Outliers: dots whose residuals neither noise nor smooth model errors explain.

A model that does not suit (a lens of another kind, a bent print) makes large residuals, too, but alike for
neighbours in a picture. An outlier is off by itself.
"""

import numpy as np
from jaxtyping import Bool, Float64, Int64

from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.scatter import Scatter

FALSE_ALARMS = 0.01
"""Expected number of good dots that are called outliers in a whole adjustment."""
_NEIGHBOURS = 8
_TIMES = 5.0
"""Ratio of the distance of an outlier from the median of its neighbours to theirs; steep near edges."""
_MOST = 0.5
"""Share of a picture's dots from which on all of it is off."""


def outliers(
    observations: Observations,
    residual: Float64[np.ndarray, "n 2"],
    dots: Float64[np.ndarray, "dots 3"],
    share: float,
) -> Bool[np.ndarray, " n"]:
    """Return a mask of outliers.

    Parameters
    ----------
    observations : Observations
        With the covariances of the measured positions alone.
    residual : ndarray, shape (n, 2)
        Predicted minus measured, px.
    dots : ndarray, shape (dots, 3)
        Centres in the target's frame, mm; nearest ones are neighbours.
    share : float
        Degrees of freedom over the number of residuals' components.

    Notes
    -----
    Both a residual and its difference from the median of its neighbours' must exceed a bound that normal
    noise, as wide as the median says, exceeds :data:`FALSE_ALARMS` times in all of the observations; and the
    difference is far larger than those among the neighbours.
    """
    scatter = Scatter.of(residual, observations.covariance, share)
    extra = scatter.robust_extra_variance()
    bound = -2.0 * np.log(FALSE_ALARMS / max(len(residual), 1))
    off = np.asarray(scatter.squares(extra) > bound)
    for picture in observations.pictures:
        of_picture = off[picture.rows]  # a view of it
        candidates = np.flatnonzero(of_picture)
        if len(candidates) == 0:
            continue
        places = dots[observations.dot[picture.rows]]
        apart, usual = relative_to_neighbours(residual[picture.rows], places, candidates)
        covariance = observations.covariance[picture.rows][candidates]
        beyond_noise = Scatter.of(apart, covariance, share).squares(extra) > bound
        of_picture[candidates] = beyond_noise & (np.linalg.norm(apart, axis=1) > _TIMES * usual)
        if of_picture.mean() > _MOST:
            of_picture[:] = True
    return off


def relative_to_neighbours(
    residual: Float64[np.ndarray, "m 2"],
    places: Float64[np.ndarray, "m 3"],
    candidates: Int64[np.ndarray, " c"],
) -> tuple[Float64[np.ndarray, "c 2"], Float64[np.ndarray, " c"]]:
    """Return distances of residuals from the median of the nearest dots, and the same of these, px.

    Parameters
    ----------
    residual : ndarray, shape (m, 2)
        Of a picture's dots, px.
    places : ndarray, shape (m, 3)
        In the target's frame, mm.
    candidates : ndarray of int, shape (c,)
        The dots that are asked for.
    """
    if len(places) <= 1:
        return residual[candidates], np.zeros(len(candidates))
    distance = ((places[candidates, None] - places) ** 2).sum(axis=2)
    distance[np.arange(len(candidates)), candidates] = np.inf
    nearest = np.argsort(distance, axis=1, kind="stable")[:, : min(_NEIGHBOURS, len(places) - 1)]
    middle = np.median(residual[nearest], axis=1)
    usual = np.median(np.linalg.norm(residual[nearest] - middle[:, None], axis=2), axis=1)
    return residual[candidates] - middle, np.asarray(usual)
