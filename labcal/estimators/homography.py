"""A homography from each image to one known plane, averaged over the cameras."""

from typing import ClassVar

import numpy as np
from jaxtyping import Float64

from labcal.estimators.closed_form import ClosedFormEstimator
from labcal.estimators.estimator import FittedArray
from labcal.geometry.arrangement import (
    camera_count,
    refuse_collinear,
    refuse_few,
    refuse_other_than_points,
    refuse_several_planes,
)
from labcal.geometry.projective_map import homogeneous, projective_map

UNKNOWN_POINTS = 4
"""A homography has eight degrees of freedom and every point gives two equations."""


class Homography(ClosedFormEstimator):
    """The method ``homography``: planes of constant Z only, any number of cameras.

    For each camera the homography from the plane to its image is found by the direct linear transform and
    inverted; X and Y are the mean over the cameras and Z is the constant of the training.

    Attributes
    ----------
    homographies_ : float64 array, (cameras, 3, 3)
        From homogeneous pixels to homogeneous X, Y in mm.
    plane_z_ : float64 array, ()
        Z of the plane, mm.
    """

    method: ClassVar[str] = "homography"

    def fitted_arrays(self) -> tuple[FittedArray, ...]:
        """Return the arrays that make up the fitted estimator."""
        return (FittedArray("homographies_", (self.n_features_in_ // 2, 3, 3)), FittedArray("plane_z_", ()))

    def _fit(self, pixels: Float64[np.ndarray, "n inputs"], points: Float64[np.ndarray, "n outputs"]) -> None:
        cameras = camera_count(self.method, pixels.shape[1])
        refuse_other_than_points(self.method, points.shape[1])
        refuse_few(self.method, points, UNKNOWN_POINTS)
        refuse_collinear(self.method, points)
        refuse_several_planes(self.method, points)
        seen = pixels.reshape(len(pixels), cameras, 2)
        for camera in range(cameras):
            refuse_collinear(f"{self.method}, camera {camera + 1}", seen[:, camera])
        maps = np.stack(
            [projective_map(self.method, points[:, :2], seen[:, camera]) for camera in range(cameras)]
        )
        self.homographies_ = np.linalg.inv(maps)
        self.plane_z_ = np.array(points[0, 2])

    def _predict(self, pixels: Float64[np.ndarray, "n inputs"]) -> Float64[np.ndarray, "n outputs"]:
        seen = pixels.reshape(len(pixels), -1, 2)
        total = np.zeros((len(pixels), 2))
        for camera, homography in enumerate(self.homographies_):
            mapped = homogeneous(seen[:, camera]) @ homography.T
            total += mapped[:, :2] / mapped[:, 2:]
        return np.column_stack((total / len(self.homographies_), np.full(len(pixels), self.plane_z_)))
