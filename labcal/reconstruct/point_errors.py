"""The independent sources of the errors of some points, and the points' derivatives by them."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from labcal.arrays import PointCovariances


@dataclass(frozen=True, eq=False)
class PointErrors:
    """Errors of k points, to first order: noise of their own, and linear functions of errors that they share.

    Shared errors are those of the cameras, and those of a frame: noise of the points that determine it, and
    coordinates that are known for these.

    Attributes
    ----------
    own : float64 array, (k, 3, 3)
        Covariance of each point's own noise, mm squared; 0 of a point whose noise is among the shared errors.
    by_shared : float64 array, (k, 3, shared)
    shared : float64 array, (shared, shared)
        Covariance of the shared errors that are none of the cameras'.
    stated : bool array, (shared,)
        Mask of those that come from known coordinates or lengths; the others are noise.
    by_cameras : float64 array, (k, 3, parameters)
    cameras : float64 array, (parameters, parameters)
        Joint covariance of the cameras' parameters.
    """

    own: PointCovariances
    by_shared: Float64[np.ndarray, "k 3 shared"]
    shared: Float64[np.ndarray, "shared shared"]
    stated: Bool[np.ndarray, " shared"]
    by_cameras: Float64[np.ndarray, "k 3 parameters"]
    cameras: Float64[np.ndarray, "parameters parameters"]

    @classmethod
    def without_shared_noise(
        cls,
        own: PointCovariances,
        by_cameras: Float64[np.ndarray, "k 3 parameters"],
        cameras: Float64[np.ndarray, "parameters parameters"],
    ) -> "PointErrors":
        """Return the errors of points in the world of their rig, which share those of the cameras alone."""
        return cls(
            own, np.zeros((len(own), 3, 0)), np.zeros((0, 0)), np.zeros(0, dtype=bool), by_cameras, cameras
        )

    def __len__(self) -> int:
        return len(self.own)

    @property
    def joint(self) -> Float64[np.ndarray, "coordinates coordinates"]:
        """Joint covariance of the points, (3 k, 3 k), mm squared: x, y, z point by point."""
        joint = np.zeros((3 * len(self), 3 * len(self)))
        for by, covariance in ((self.by_shared, self.shared), (self.by_cameras, self.cameras)):
            flat = by.reshape(3 * len(self), -1)
            joint += flat @ covariance @ flat.T
        for number, own in enumerate(self.own):
            at = slice(3 * number, 3 * number + 3)
            joint[at, at] += own
        return joint

    def and_others(self, others: "PointErrors") -> "PointErrors":
        """Return the errors of these points and of others that share the same ones, in this order."""
        return PointErrors(
            np.concatenate([self.own, others.own]),
            np.concatenate([self.by_shared, others.by_shared]),
            self.shared,
            self.stated,
            np.concatenate([self.by_cameras, others.by_cameras]),
            self.cameras,
        )
