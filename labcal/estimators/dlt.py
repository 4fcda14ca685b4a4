"""The direct linear transform of each camera, followed by linear triangulation."""

from typing import ClassVar

import numpy as np
from jaxtyping import Float64

from labcal.errors import InputError
from labcal.estimators.closed_form import ClosedFormEstimator
from labcal.estimators.estimator import FittedArray
from labcal.geometry.arrangement import (
    camera_count,
    refuse_collinear,
    refuse_few,
    refuse_one_plane,
    refuse_other_than_points,
)
from labcal.geometry.projective_map import projective_map

UNKNOWN_POINTS = 6
"""A projection matrix has eleven degrees of freedom and every point gives two equations."""

CAMERAS = 2
"""Fewer cameras see rays, not points."""


class Dlt(ClosedFormEstimator):
    """The method ``dlt``: volumes only, two cameras or more, no lens distortion.

    Abdel-Aziz and Karara 1971, with Hartley's normalisation. Points are triangulated linearly: every camera
    gives two equations ``(x P3 - P1) p = 0`` and ``(y P3 - P2) p = 0``, solved by least squares for
    p = (X, Y, Z, 1) (Hartley and Sturm, "Triangulation", 1997, the inhomogeneous linear method). With rows P3
    of unit length the equations' errors are pixel errors times the depth.

    Attributes
    ----------
    projections_ : float64 array, (cameras, 3, 4)
        From homogeneous points in mm to homogeneous pixels; the third row gives the depth in mm.
    """

    method: ClassVar[str] = "dlt"

    def fitted_arrays(self) -> tuple[FittedArray, ...]:
        """Return the arrays that make up the fitted estimator."""
        return (FittedArray("projections_", (self.n_features_in_ // 2, 3, 4)),)

    def _fit(self, pixels: Float64[np.ndarray, "n inputs"], points: Float64[np.ndarray, "n outputs"]) -> None:
        cameras = camera_count(self.method, pixels.shape[1])
        if cameras < CAMERAS:
            raise InputError(
                f"{self.method}: X has the columns of one camera, but triangulation needs two or more."
            )
        refuse_other_than_points(self.method, points.shape[1])
        refuse_few(self.method, points, UNKNOWN_POINTS)
        refuse_collinear(self.method, points)
        refuse_one_plane(self.method, points)
        seen = pixels.reshape(len(pixels), cameras, 2)
        maps = np.stack([projective_map(self.method, points, seen[:, camera]) for camera in range(cameras)])
        self.projections_ = maps / np.linalg.norm(maps[:, 2:, :3], axis=2, keepdims=True)

    def _predict(self, pixels: Float64[np.ndarray, "n inputs"]) -> Float64[np.ndarray, "n outputs"]:
        seen = pixels.reshape(len(pixels), -1, 2)
        first_two, third = self.projections_[:, :2], self.projections_[:, 2]
        equations = seen[..., None] * third[:, None, :] - first_two
        equations = equations.reshape(len(pixels), -1, 4)
        inverse = np.linalg.pinv(equations[..., :3])
        return np.asarray(-np.einsum("nij,nj->ni", inverse, equations[..., 3]))
