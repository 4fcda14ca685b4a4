"""The common part of methods with cameras: triangulation, and its covariance."""

from abc import abstractmethod
from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels, Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.triangulation import TriangulatedPoints
from labcal.errors import InputError
from labcal.estimators.estimator import FittedArray, PointEstimator
from labcal.estimators.fitted_arrays import FIGURES, FittedArrays, free_count, from_arrays, to_arrays
from labcal.estimators.gp_field.fitted_camera import FittedCamera, triangulated
from labcal.geometry.arrangement import camera_count, refuse_other_than_points
from labcal.run.threads import one_blas_thread
from labcal.wording import counted

_CAMERAS = 2
"""Fewer cameras see rays, not points."""


class CameraEstimator(PointEstimator):
    """A method that estimates a camera for each pair of columns, and triangulates.

    Points are the most likely ones for pixels with independent normal noise, and their covariances hold the
    noise as well as how sure the cameras are.

    Parameters
    ----------
    image_sizes : tuple of (int, int), optional
        Width and height, px, of each camera's pictures. Where left out, pictures reach as far as the trained
        pixels.

    Attributes
    ----------
    cameras_text_ : str
        The lens formulas, as JSON.
    middle_, figures_, covariances_, inputs_, residuals_ : float64 array
        As in `FittedArrays`.
    trained_points_ : float64 array, (n, 3)
        Mm.
    n_trained_ : int
    """

    fitted_facts: ClassVar[tuple[str, ...]] = ("cameras_text_", "n_trained_")
    image_sizes: tuple[tuple[int, int], ...] | None

    def fitted_arrays(self) -> tuple[FittedArray, ...]:
        """Return the arrays that make up the fitted estimator."""
        cameras, free = free_count(self.cameras_text_)
        n = self.n_trained_
        return (
            FittedArray("middle_", (3,)),
            FittedArray("figures_", (cameras, FIGURES)),
            FittedArray("covariances_", (cameras, free, free)),
            FittedArray("inputs_", (cameras, n, 3)),
            FittedArray("residuals_", (cameras, n, 2)),
            FittedArray("trained_points_", (n, 3)),
        )

    @property
    def fitted_cameras_(self) -> tuple[FittedCamera, ...]:
        """The cameras, in the order of the columns."""
        arrays = FittedArrays(
            self.cameras_text_,
            self.middle_,
            self.figures_,
            self.covariances_,
            self.inputs_,
            self.residuals_,
        )
        return from_arrays(arrays, self.trained_points_)

    @property
    def cameras_(self) -> tuple[Camera, ...]:
        """The lens formulas, in the order of the columns."""
        return tuple(camera.camera for camera in self.fitted_cameras_)

    @abstractmethod
    def _fitted(self, q: Pixels, p: Vectors3, size: tuple[int, int]) -> FittedCamera:
        """Return the camera that was estimated from points (mm) and pixels."""

    @one_blas_thread()
    def _fit(self, pixels: Float64[np.ndarray, "n inputs"], points: Float64[np.ndarray, "n outputs"]) -> None:
        count = camera_count(self.method, pixels.shape[1])
        if count < _CAMERAS:
            raise InputError(
                f"{self.method}: X has the columns of one camera, but triangulation needs two or more."
            )
        refuse_other_than_points(self.method, points.shape[1])
        seen = pixels.reshape(len(pixels), count, 2)
        sizes = self._sizes(seen)
        self._keep([self._fitted(seen[:, i], points, size) for i, size in enumerate(sizes)], points)

    def _keep(self, cameras: Sequence[FittedCamera], points: Vectors3) -> None:
        """Store cameras that were estimated from points, mm."""
        arrays = to_arrays(cameras, len(points))
        self.cameras_text_, self.n_trained_ = arrays.text, len(points)
        self.middle_, self.figures_, self.covariances_ = arrays.middle, arrays.figures, arrays.covariance
        self.inputs_, self.residuals_ = arrays.inputs, arrays.residuals
        self.trained_points_ = points

    def _predict(self, pixels: Float64[np.ndarray, "n inputs"]) -> Float64[np.ndarray, "n outputs"]:
        return self._triangulated(pixels, self._own_noise(len(pixels))).point

    def _with_covariance(
        self,
        pixels: Float64[np.ndarray, "n inputs"],
        pixel_covariance: Float64[np.ndarray, "n cameras 2 2"],
    ) -> tuple[Float64[np.ndarray, "n outputs"], Float64[np.ndarray, "n dim dim"]]:
        found = self._triangulated(pixels, pixel_covariance)
        return found.point, found.covariance

    @one_blas_thread()
    def _triangulated(
        self, pixels: Float64[np.ndarray, "n inputs"], covariance: Float64[np.ndarray, "n cameras 2 2"]
    ) -> TriangulatedPoints:
        return triangulated(self.fitted_cameras_, pixels.reshape(len(pixels), -1, 2), covariance)

    def _own_noise(self, n: int) -> Float64[np.ndarray, "n cameras 2 2"]:
        """Return the covariances of n points with the pixel noise of training."""
        noise = self.figures_[:, 0]
        return np.tile(noise[:, None, None] ** 2 * np.eye(2), (n, 1, 1, 1))

    def _sizes(self, seen: Float64[np.ndarray, "n cameras 2"]) -> Sequence[tuple[int, int]]:
        """Return the picture sizes by camera."""
        if self.image_sizes is None:
            reach = np.ceil(np.maximum(seen.max(axis=0), 1.0)).astype(int) + 1
            return [(int(width), int(height)) for width, height in reach]
        if len(self.image_sizes) != seen.shape[1]:
            raise InputError(
                f"{self.method}: image_sizes names {counted(len(self.image_sizes), 'picture')}, but X has "
                f"the columns of {counted(seen.shape[1], 'camera')}."
            )
        return self.image_sizes
