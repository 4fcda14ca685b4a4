"""The adjustment with the dots' places among the unknowns."""

from dataclasses import dataclass

import numpy as np

from labcal.calibrate.adjustment.dot_freedom import (
    SHAPES,
    Constrained,
    DatumConstraint,
    dot_freedom,
    plane_modes,
)
from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.problem import AdjustmentProblem
from labcal.calibrate.adjustment.rounds import Adjusted, adjust_in_rounds
from labcal.calibrate.adjustment.state import Freedom, Lenses
from labcal.calibrate.freed_dots import MIN_PICTURES, FreedDots
from labcal.errors import InputError
from labcal.targets.catalogue import AnyTarget
from labcal.wording import counted

_FEWEST_DOTS = 8
_WORSE = 10.0
"""Factor by which heights, stretch or keystone may be less certain than the rest of the places and still be
taken from the views. For heights, tilts of some 6 degrees are enough."""


@dataclass(frozen=True)
class DotsAdjusted:
    """An adjustment with free dots."""

    adjusted: Adjusted
    observations: Observations
    """Those that entered: dots in too few pictures are left out."""
    dots: FreedDots


def adjust_dots(
    flat: Adjusted, observations: Observations, target: AnyTarget, lenses: Lenses, eccentricity_rounds: int
) -> DotsAdjusted:
    """Free the dots after an adjustment that took them as declared.

    Dots in fewer than :data:`MIN_PICTURES` pictures stay where they are declared, and their measurements do
    not enter. Heights, stretch and keystone are freed only where the views tell them: through a long lens, a
    print that is longer along x looks like one that is turned.

    Parameters
    ----------
    flat : Adjusted
        The start, with the target's declared places.
    observations : Observations
        Centroids as measured.
    target : AnyTarget
    lenses : Lenses
    eccentricity_rounds : int
        As in :func:`adjust_in_rounds`.

    Raises
    ------
    InputError
        Too few dots are in enough pictures, or more are than can be free at once, or the target looks the
        same when turned.
    """
    if target.symmetric_indices(target.indices()[:1]):
        raise InputError(
            f"The target '{target.name}' looks the same when turned, so views may number its dots "
            "differently. Free the dots of a target with rings, or keep these as declared: "
            "`dot_places='declared'`."
        )
    pictures = np.bincount(observations.dot, minlength=target.count)
    movable = pictures >= MIN_PICTURES
    if movable.sum() < _FEWEST_DOTS:
        raise InputError(
            f"Only {counted(int(movable.sum()), 'dot')} measured in at least {MIN_PICTURES} pictures, too "
            "few to free them. Take more pictures that show the same dots, or keep them as declared: "
            "`dot_places='declared'`."
        )
    entering = observations.where(movable[observations.dot])
    hold = datum_constraint(flat, entering, movable, lenses)
    basis = dot_freedom(flat.state.dots, movable, hold)
    radii = 0.5 * target.outer_diameters_mm()
    adjusted = adjust_in_rounds(flat.state, entering, Freedom(lenses, basis), radii, eccentricity_rounds)
    at = adjusted.layout.dots
    covariance = basis @ adjusted.covariance[at, at] @ basis.T
    dots = FreedDots(
        target=target,
        place=adjusted.state.dots,
        covariance=covariance.reshape(target.count, 3, target.count, 3),
        pictures=pictures,
        freed=movable,
        constrained=hold.parts,
    )
    return DotsAdjusted(adjusted, entering, dots)


def datum_constraint(
    flat: Adjusted, observations: Observations, movable: np.ndarray, lenses: Lenses
) -> DatumConstraint:
    """Return the datum constraint, by normal equations with all dots free."""
    nothing = DatumConstraint.nothing(len(movable))
    basis = dot_freedom(flat.state.dots, movable, nothing)
    problem = AdjustmentProblem(observations.scattered(flat.scatter_px**2), Freedom(lenses, basis))
    end = problem.linearize(flat.state)
    at = end.layout.dots
    variance = basis @ end.shared_spread()[at, at] @ basis.T
    modes = plane_modes(flat.state.dots, movable)
    # Symmetric products with a projector: what is left when a homography is taken out.
    rest = variance - modes @ (modes.T @ variance)
    rest -= (rest @ modes) @ modes.T
    x, y, z = np.diagonal(rest).reshape(-1, 3)[movable].mean(axis=0)
    most = _WORSE**2 * max(x, y)
    parts = Constrained.HEIGHTS if z > most else Constrained.NOTHING
    shapes = modes[:, -SHAPES:]
    spread, axes = np.linalg.eigh(shapes.T @ variance @ shapes)
    kept = axes[:, spread > most]
    for direction in kept.T:
        stretched = (direction[: SHAPES // 2] ** 2).sum() > 0.5  # noqa: PLR2004 -- the larger part
        parts |= Constrained.STRETCH if stretched else Constrained.KEYSTONE
    return DatumConstraint(parts, shapes @ kept)
