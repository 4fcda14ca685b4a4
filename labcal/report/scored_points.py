"""Points that count in an evaluation, where they should be, and their errors."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from labcal.arrays import Vectors3
from labcal.correspond.matching import rows_by_name
from labcal.correspond.points import Points
from labcal.errors import InputError
from labcal.geometry.poses import rigid_alignment, transform
from labcal.targets.places import DotPlaces
from labcal.targets.target import Target

FEWEST = 3
"""Points of a view that its target can be laid onto."""
_LAID_ON = (
    "The reconstructed points, and the target laid onto them in every view with the least sum of squares. An "
    "error vector leads from a point to its dot on that target."
)


@dataclass(frozen=True)
class ScoredPoints:
    """Points that count, in the world in which their errors are drawn.

    Attributes
    ----------
    points : Points
    places : float64 array, (n, 3)
        Where they should be, mm.
    error : float64 array, (n, 3)
        Of each, mm.
    description : str
        What a figure of them shows.
    """

    points: Points
    places: Vectors3
    error: Vectors3
    description: str


def laid_on(points: Points, views: Sequence[str], target: Target | DotPlaces) -> ScoredPoints:
    """Return the points of scored views, and the places of the target laid onto those of each view."""
    board = target.target if isinstance(target, DotPlaces) else target
    known = np.isfinite(points.point).all(axis=1) & np.isin(points.view, views)
    numbers = points.index[:, 1] * board.cols + points.index[:, 0]
    if isinstance(target, DotPlaces):
        known &= target.freed()[numbers]
    kept, dots = points.where(known), target.points()[numbers[known]]
    places = np.full(kept.point.shape, np.nan)
    for rows in rows_by_name(kept.view).values():
        if len(rows) < FEWEST:
            continue
        try:
            places[rows] = transform(rigid_alignment(kept.point[rows], dots[rows]), dots[rows])
        except InputError:  # all on one line
            continue
    laid = np.isfinite(places).all(axis=1)
    kept, places = kept.where(laid), places[laid]
    return ScoredPoints(kept, places, kept.point - places, _LAID_ON)
