"""The direct linear transform of each camera, followed by linear triangulation."""

from typing import ClassVar

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels, Vectors3
from labcal.errors import InputError
from labcal.estimators.estimator import FittedArray
from labcal.estimators.linear_camera_estimator import LinearCameraEstimator
from labcal.estimators.linear_model_error import LinearModelError, Slopes
from labcal.estimators.scaling import RangeScaling
from labcal.geometry.arrangement import (
    camera_count,
    refuse_collinear,
    refuse_few,
    refuse_one_plane,
    refuse_other_than_points,
)
from labcal.geometry.projective_map import AMBIGUOUS, homogeneous, projective_map

UNKNOWN_POINTS = 6
"""A projection matrix has eleven degrees of freedom and every point gives two equations."""

CAMERAS = 2
"""Fewer cameras see rays, not points."""
_PARAMETERS = 12
"""Of a projection; one direction, its scale, moves no pixel."""
_LACKING = tuple((d - j, j) for d in (2, 3) for j in range(d + 1))
"""Powers of scaled pixel coordinates in the displacements that a projection lacks."""


class Dlt(LinearCameraEstimator):
    """The method ``dlt``: volumes only, two cameras or more, no lens distortion.

    Abdel-Aziz and Karara 1971, with Hartley's normalisation. Points are triangulated linearly: every camera
    gives two equations ``(x P3 - P1) p = 0`` and ``(y P3 - P2) p = 0``, solved by least squares for
    p = (X, Y, Z, 1) (Hartley and Sturm, "Triangulation", 1997, the inhomogeneous linear method). With rows P3
    of unit length the equations' errors are pixel errors times the depth.

    What the projections lack are displacements of the second and third degree in the picture, those of a
    decentred and of a radially distorting lens; `LinearCameraEstimator` says how they enter the covariance.

    Attributes
    ----------
    projections_ : float64 array, (cameras, 3, 4)
        From homogeneous points in mm to homogeneous pixels; the third row gives the depth in mm.
    centre_, half_range_ : float64 array, (3,)
        The scaling of points in the errors of the projections, mm.
    pixel_centre_, pixel_half_range_ : float64 array, (inputs,)
        The scaling of pixels there.
    """

    method: ClassVar[str] = "dlt"

    def fitted_arrays(self) -> tuple[FittedArray, ...]:
        """Return the arrays that make up the fitted estimator."""
        return (
            FittedArray("projections_", (self.n_features_in_ // 2, 3, 4)),
            FittedArray("centre_", (3,)),
            FittedArray("half_range_", (3,)),
            FittedArray("pixel_centre_", (self.n_features_in_,)),
            FittedArray("pixel_half_range_", (self.n_features_in_,)),
        )

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
        space, picture = RangeScaling.of(points), RangeScaling.of(pixels)
        self.centre_, self.half_range_ = space.centre, space.half_range
        self.pixel_centre_, self.pixel_half_range_ = picture.centre, picture.half_range
        self._keep_errors([self._model_error(i, seen[:, i], points) for i in range(cameras)])

    def _predict(self, pixels: Float64[np.ndarray, "n inputs"]) -> Float64[np.ndarray, "n outputs"]:
        seen = pixels.reshape(len(pixels), -1, 2)
        first_two, third = self.projections_[:, :2], self.projections_[:, 2]
        equations = seen[..., None] * third[:, None, :] - first_two
        equations = equations.reshape(len(pixels), -1, 4)
        inverse = np.linalg.pinv(equations[..., :3])
        return np.asarray(-np.einsum("nij,nj->ni", inverse, equations[..., 3]))

    def _sizes(self) -> tuple[int, int]:
        return _PARAMETERS, 2 * len(_LACKING)

    def _slopes(self, camera: int, q: Pixels, p: Vectors3) -> Slopes:  # noqa: ARG002 - see below
        """Return derivatives by the projection of scaled points to scaled pixels, and by displacements.

        Both are taken at the images of the points: at noisy pixels, displacements that a projection takes up
        exactly would seem to be lacking.
        """
        picture, (seen, depth) = self._picture(camera), self._projected(camera, p)
        source = homogeneous(RangeScaling(self.centre_, self.half_range_).scaled(p)) / depth[:, None]
        by_parameter = np.zeros((len(p), 2, 3, 4))
        by_parameter[:, 0, 0] = by_parameter[:, 1, 1] = source
        by_parameter[:, :, 2] = -picture.scaled(seen)[:, :, None] * source[:, None, :]
        u, v = picture.scaled(seen).T
        terms = np.stack([u**i * v**j for i, j in _LACKING], axis=1)
        by_lacking = terms[:, None, None, :] * np.eye(2)[:, :, None]
        return Slopes(
            picture.half_range[:, None] * by_parameter.reshape(len(p), 2, -1),
            by_lacking.reshape(len(p), 2, -1),
        )

    def _model_error(self, camera: int, q: Pixels, p: Vectors3) -> LinearModelError:
        """Return the error of a camera that was fitted to pixels and points, mm.

        The equations of the transform are those of pixels, times the depth.
        """
        seen, depth = self._projected(camera, p)
        slopes = self._slopes(camera, q, p)
        weighted = (depth[:, None, None] * slopes.by_parameter).reshape(-1, _PARAMETERS)
        response = np.linalg.pinv(weighted, rcond=AMBIGUOUS).reshape(_PARAMETERS, len(p), 2)
        response = (response * depth[:, None]).transpose(1, 0, 2)
        return LinearModelError.of(seen - q, response, slopes)

    def _projected(self, camera: int, p: Vectors3) -> tuple[Pixels, Float64[np.ndarray, " n"]]:
        """Return the images of points, px, and their depths, mm."""
        image = homogeneous(p) @ self.projections_[camera].T
        return image[:, :2] / image[:, 2:], image[:, 2]

    def _picture(self, camera: int) -> RangeScaling:
        columns = slice(2 * camera, 2 * camera + 2)
        return RangeScaling(self.pixel_centre_[columns], self.pixel_half_range_[columns])
