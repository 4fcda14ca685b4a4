"""The estimated places of free dots on a print."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from labcal.calibrate.adjustment.dot_freedom import Constrained
from labcal.targets.catalogue import AnyTarget
from labcal.targets.places import DotPlaces

MIN_PICTURES = 3
"""Pictures that a dot must be in before its place is taken from them: two fix it, the third checks."""


@dataclass(frozen=True)
class FreedDots:
    """Dots of a target by row and column, where they were found.

    Pictures do not tell the size of what they show: the mean scale is that of the declared pitch, and the
    mean shift and rotation against the declared places are 0.
    """

    target: AnyTarget
    place: Float64[np.ndarray, "dots 3"]
    """In the target's frame, mm; the declared place where not freed."""
    covariance: Float64[np.ndarray, "dots 3 dots 3"]
    """Of all places together, mm squared; 0 for what was not freed."""
    pictures: Int64[np.ndarray, " dots"]
    """In how many pictures each dot was measured."""
    freed: Bool[np.ndarray, " dots"]
    constrained: Constrained
    """Parts that the datum constraint keeps as declared for all dots."""

    def places(self) -> DotPlaces:
        """Return the document of the places."""
        return DotPlaces.of(self.target, self.place, self.own_covariance, self.pictures, self.freed)

    @property
    def displacement(self) -> Float64[np.ndarray, "dots 3"]:
        """Found minus declared, mm."""
        return np.asarray(self.place - self.target.points())

    @property
    def sigma(self) -> Float64[np.ndarray, "dots 3"]:
        """Standard deviations of the places, mm."""
        count = len(self.place)
        variance = np.diagonal(self.covariance.reshape(3 * count, 3 * count)).reshape(count, 3)
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)))

    @property
    def own_covariance(self) -> Float64[np.ndarray, "dots 3 3"]:
        """The covariance of every dot by itself, mm squared."""
        numbers = np.arange(len(self.place))
        return np.asarray(self.covariance[numbers, :, numbers])
