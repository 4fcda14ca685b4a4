"""Dots that lie where neither their noise nor what the model does not know puts them.

A model that does not suit (a lens of another kind, a bent print) makes large residuals, too, but alike for
neighbours in a picture. An outlier is off by itself.
"""

import numpy as np
from jaxtyping import Bool, Float64, Int64

from labcal.solve.adjustment.observations import Observations
from labcal.solve.adjustment.scatter import Scatter

FALSE_ALARMS = 0.01
"""How many sound dots are expected to be called outliers in a whole adjustment."""
_NEIGHBOURS = 8
_MOST = 0.5
"""Share of a picture's dots from which on all of it is off."""


def outliers(
    observations: Observations,
    residual: Float64[np.ndarray, "n 2"],
    dots: Float64[np.ndarray, "dots 3"],
    share: float,
) -> Bool[np.ndarray, " n"]:
    """Return which observations are outliers.

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
    noise, as wide as the median says, exceeds :data:`FALSE_ALARMS` times in all of the observations.
    """
    scatter = Scatter.of(residual, observations.covariance, share)
    extra = scatter.robust_extra_variance()
    bound = -2.0 * np.log(FALSE_ALARMS / max(len(residual), 1))
    off = scatter.squares(extra) > bound
    for picture in observations.pictures:
        of_picture = off[picture.rows]  # a view of it
        candidates = np.flatnonzero(of_picture)
        if len(candidates) == 0:
            continue
        surroundings = _surroundings(residual[picture.rows], dots[observations.dot[picture.rows]], candidates)
        apart = residual[picture.rows][candidates] - surroundings
        covariance = observations.covariance[picture.rows][candidates]
        of_picture[candidates] = Scatter.of(apart, covariance, share).squares(extra) > bound
        if of_picture.mean() > _MOST:
            of_picture[:] = True
    return off


def _surroundings(
    residual: Float64[np.ndarray, "m 2"],
    places: Float64[np.ndarray, "m 3"],
    candidates: Int64[np.ndarray, " c"],
) -> Float64[np.ndarray, "c 2"]:
    """Return the median residual of the nearest dots of the same picture; 0 where there are none."""
    if len(places) <= 1:
        return np.zeros((len(candidates), 2))
    apart = ((places[candidates, None] - places) ** 2).sum(axis=2)
    apart[np.arange(len(candidates)), candidates] = np.inf
    nearest = np.argsort(apart, axis=1, kind="stable")[:, : min(_NEIGHBOURS, len(places) - 1)]
    return np.asarray(np.median(residual[nearest], axis=1))
