"""The adjustment with the dots' places among the unknowns."""

from dataclasses import dataclass

import numpy as np

from labcal.errors import InputError
from labcal.solve.adjustment.dot_freedom import DotMotion, dot_freedom
from labcal.solve.adjustment.observations import Observations
from labcal.solve.adjustment.rounds import Adjusted, adjust_in_rounds
from labcal.solve.adjustment.state import Freedom, Lenses
from labcal.solve.freed_dots import MIN_PICTURES, FreedDots
from labcal.targets.grid import DotGrid

_FEWEST_DOTS = 8
_HEIGHT_WORSE = 10.0
"""Height over in-plane uncertainty up to which heights are taken from the views; tilts of 6 degrees do."""


@dataclass(frozen=True)
class DotsAdjusted:
    """An adjustment with free dots."""

    adjusted: Adjusted
    observations: Observations
    """Those that entered: dots in too few pictures are left out."""
    dots: FreedDots


def adjust_dots(
    flat: Adjusted, observations: Observations, target: DotGrid, lenses: Lenses, bias_rounds: int
) -> DotsAdjusted:
    """Free the dots after an adjustment that took them as declared.

    Dots in fewer than :data:`MIN_PICTURES` pictures stay where they are declared, and their measurements do
    not enter. Heights are freed only where the views tell them.

    Parameters
    ----------
    flat : Adjusted
        The start, with the target's declared places.
    observations : Observations
        Centroids as measured.
    target : DotGrid
    lenses : Lenses
    bias_rounds : int
        As in :func:`adjust_in_rounds`.

    Raises
    ------
    InputError
        Too few dots are in enough pictures, or more are than can be free at once.
    """
    pictures = np.bincount(observations.dot, minlength=target.count)
    movable = pictures >= MIN_PICTURES
    if movable.sum() < _FEWEST_DOTS:
        raise InputError(
            f"Only {movable.sum()} dots were measured in at least {MIN_PICTURES} pictures, too few to free "
            "them. Take more pictures that show the same dots, or leave --free-dots out."
        )
    entering = observations.where(movable[observations.dot])
    radii = 0.5 * target.outer_diameters_mm()
    for motion in (DotMotion.IN_SPACE, DotMotion.IN_PLANE):
        basis = dot_freedom(flat.state.dots, movable, motion)
        adjusted = adjust_in_rounds(flat.state, entering, Freedom(lenses, basis), radii, bias_rounds)
        at = adjusted.layout.dots
        covariance = basis @ adjusted.covariance[at, at] @ basis.T
        dots = FreedDots(
            target=target,
            place=adjusted.state.dots,
            covariance=covariance.reshape(target.count, 3, target.count, 3),
            pictures=pictures,
            freed=movable,
            z_freed=motion is DotMotion.IN_SPACE,
        )
        x, y, z = np.sqrt((dots.sigma[movable] ** 2).mean(axis=0))
        if np.isfinite(covariance).all() and z <= _HEIGHT_WORSE * max(x, y):
            break
    return DotsAdjusted(adjusted, entering, dots)
