"""Errors of a stage's readings, and what they add to the points of a method that was fitted on it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import radians
from typing import Annotated

import numpy as np
from jaxtyping import Float64
from pydantic import BaseModel, ConfigDict, Field, model_validator

from labcal.arrays import PointCovariances, Pose, Vectors3
from labcal.cameras.calibration_share import calibration_share
from labcal.cameras.camera import Camera
from labcal.cameras.lower_triangle import (
    MOST_PARAMETERS,
    Element,
    full_matrix,
    lower_triangle,
    require_covariance,
)
from labcal.cameras.parameter_derivatives import POSE, parameter_derivatives, posed_slices
from labcal.correspond.training import TrainingData
from labcal.geometry.cross_matrices import cross_matrices

_DETERMINED = 1e-12
"""Share of the largest eigenvalue of a scaled normal matrix below which a combination is not determined."""


@dataclass(frozen=True)
class StageSigma:
    """Standard deviations of a stage's readings, independent from view to view.

    Attributes
    ----------
    mm : float
        Of the place of the target's origin, along each axis.
    deg : float
        Of the target's rotation about its origin, about each axis.
    """

    mm: float
    deg: float


class StageErrors(BaseModel):
    """Joint covariance of the training cameras by errors of the stage, all of their poses included."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    sigma_mm: Annotated[float, Field(ge=0, le=1e6, allow_inf_nan=False)]
    """Of the stage's places along each axis."""
    sigma_deg: Annotated[float, Field(ge=0, le=180, allow_inf_nan=False)]
    """Of the stage's rotations about each axis."""
    lower: Annotated[tuple[tuple[Element, ...], ...], Field(min_length=1, max_length=MOST_PARAMETERS)]
    """Lower triangle, a tuple for each row: camera by camera fx fy cx cy, coefficients, turn (rad) about the
    camera's axes and shift (mm) along them, in the world of the stage."""

    @model_validator(mode="after")
    def _is_a_covariance(self) -> "StageErrors":
        require_covariance(self.lower, len(self.lower))
        return self

    @property
    def matrix(self) -> Float64[np.ndarray, "parameters parameters"]:
        """The covariance as a full matrix."""
        return full_matrix(self.lower)

    def fits(self, cameras: Sequence[Camera]) -> bool:
        """Tell whether the covariance has the size that the parameters of these cameras have."""
        return len(self.lower) == int(posed_slices(cameras)[-1].stop)

    def share(
        self, cameras: Sequence[Camera], p: Vectors3, covariance: Float64[np.ndarray, "n cameras 2 2"]
    ) -> PointCovariances:
        """Return the covariances of points by errors of the stage, mm squared.

        Parameters
        ----------
        cameras : sequence of Camera
            Those of the training.
        p : ndarray, shape (n, 3)
            Mm; NaN where there is none.
        covariance : ndarray, shape (n, cameras, 2, 2)
            Of their pixels, px squared.

        Returns
        -------
        ndarray, shape (n, 3, 3)
            NaN for points that are none.
        """
        return calibration_share(cameras, self.matrix, p, covariance, posed_slices(cameras))


def stage_errors(
    cameras: Sequence[Camera], data: TrainingData, T_world_target: Mapping[str, Pose], sigma: StageSigma
) -> StageErrors:
    """Return how far cameras are off that were fitted to dots at a stage's readings.

    Parameters
    ----------
    cameras : sequence of Camera
        Resected from the training data, in the world of the stage.
    data : TrainingData
    T_world_target : mapping of str to ndarray of shape (4, 4)
        The stage's readings by view, mm.
    sigma : StageSigma

    Notes
    -----
    A camera c is where the gradient ``G_c' r_c`` of its residuals over all dots vanishes. An error d of a
    view's pose moves the dots by ``B d`` and their images by ``J_c B d``, and so the camera by
    ``-(G_c'G_c)^-1 G_c' J_c B d``, where G and J are the derivatives of pixels by the camera and by the point
    (implicit function theorem). The same error moves all cameras, whose covariance is therefore a joint one.
    """
    places = posed_slices(cameras)
    views, number = np.unique(data.view, return_inverse=True)
    origins = np.array([T_world_target[view][:3, 3] for view in views.tolist()])
    turned = -cross_matrices(data.Y - origins[number])
    by_pose = np.concatenate([turned, np.broadcast_to(np.eye(3), turned.shape)], axis=2)
    moved = np.zeros((places[-1].stop, len(views), POSE))
    for camera, place in zip(cameras, places, strict=True):
        found = parameter_derivatives(camera, data.Y)
        each = found.by_parameters.transpose(0, 2, 1) @ (found.by_point @ by_pose)
        gradient = np.zeros((len(views), *each.shape[1:]))
        np.add.at(gradient, number, each)
        G = found.by_parameters.reshape(-1, found.by_parameters.shape[2])
        moved[place] = np.einsum("ij,vjk->ivk", _inverse(G.T @ G), -gradient)
    scaled = moved * np.repeat([radians(sigma.deg), sigma.mm], 3)
    flat = scaled.reshape(len(moved), -1)
    matrix = flat @ flat.T
    return StageErrors(sigma_mm=sigma.mm, sigma_deg=sigma.deg, lower=lower_triangle(matrix))


def _inverse(normal: Float64[np.ndarray, "k k"]) -> Float64[np.ndarray, "k k"]:
    """Return the inverse; combinations of parameters that the dots do not determine stay where they are."""
    scale = np.sqrt(np.maximum(np.diagonal(normal), np.finfo(np.float64).tiny))
    spread, directions = np.linalg.eigh(normal / scale[:, None] / scale)
    determined = spread > _DETERMINED * spread[-1]
    kept = directions[:, determined] / scale[:, None]
    return np.asarray(kept / spread[determined] @ kept.T)
