"""Errors of the places of dots that the measurement of their print left."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from labcal.targets.places import DotPlaces

PLANE, SPACE = 2, 3
"""Coordinates of a dot."""


@dataclass(frozen=True)
class KnownErrors:
    """Errors of some dots, each by itself, and of all dots in common.

    Attributes
    ----------
    directions : float64 array, (all coordinates, coordinates)
        Motions of single dots, unit length: in the plane alone where nothing is known of them, else in space.
    in_plane : bool array, (coordinates,)
        Those in the plane.
    own : float64 array, (coordinates, coordinates)
        Covariance of the single dots along these directions, mm squared; zeros where nothing is known.
    common : float64 array, (all coordinates, errors)
        Errors that all dots have in common, one sigma each, mm.
    sigma_mm : float
        Root mean square standard deviation of x and y.
    """

    directions: Float64[np.ndarray, "all own"]
    in_plane: np.ndarray
    own: Float64[np.ndarray, "own own"]
    common: Float64[np.ndarray, "all errors"]
    sigma_mm: float

    @classmethod
    def of(cls, known: DotPlaces | None, some: Int64[np.ndarray, " some"], dots: int) -> "KnownErrors":
        """Return those of some dots, by their numbers, of a print; None is one that was not measured."""
        axes = PLANE if known is None else SPACE
        directions = np.zeros((SPACE * dots, axes * len(some)))
        for axis in range(axes):
            directions[SPACE * some + axis, axes * np.arange(len(some)) + axis] = 1.0
        in_plane = np.tile(np.arange(axes) < PLANE, len(some))
        own = np.zeros((axes * len(some), axes * len(some)))
        if known is None:
            return cls(directions, in_plane, own, np.zeros((SPACE * dots, 0)), 0.0)
        single = known.independent_covariances()[some]
        for number, covariance in enumerate(single):
            at = slice(axes * number, axes * (number + 1))
            own[at, at] = covariance
        common = known.common_errors()
        together = (common.reshape(dots, SPACE, -1)[some, :PLANE] ** 2).sum(axis=2)
        variance = np.diagonal(single, axis1=1, axis2=2)[:, :PLANE] + together
        return cls(directions, in_plane, own, common, float(np.sqrt(variance.mean())))
