"""Cameras resected from known points, and optimal triangulation."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from labcal.arrays import Pixels, Vectors3
from labcal.calibrate.lens_candidates import AUTO
from labcal.calibrate.resection.lens_choice import camera_of_lens, chosen_camera
from labcal.calibrate.resection.resected import ResectedCamera, resect
from labcal.cameras.window import GLASS, FlatWindow
from labcal.estimators.camera_estimator import CameraEstimator
from labcal.estimators.gp_field.fitted_camera import FittedCamera

_DISTANCES_MM = (60.0, 240.0, 1000.0)
_TILTS_DEG = ((0.0, 0.0), (20.0, 0.0), (-20.0, 0.0), (0.0, 20.0), (0.0, -20.0))
"""Initial tilts of a window. From values too far off, the search may end with the glass at the lens."""


class Bundle(CameraEstimator):
    """The method ``bundle``: each camera from the points' known places, with any lens model.

    All parameters of a camera are adjusted together from a linear start (Brown 1971); points are triangulated
    optimally. For volumes only: of a single plane a camera's focal length and distance look alike.

    Parameters
    ----------
    lens : str
        A lens model, the name or file of a lens prescription, or ``auto``: the simplest model that predicts
        held-out dots as well as any.
    image_sizes : tuple of (int, int), optional
        Width and height, px, of each camera's pictures. Where left out, pictures reach as far as the trained
        pixels.
    behind_index : float
        Refractive index of what the points are in: above 1 there is a flat window in front of each camera,
        whose tilt and distance are found.
    glass_index : float
        Of the window.
    glass_thickness_mm : float
        Of the window.

    Attributes
    ----------
    cameras_ : tuple of Camera
        In the order of the columns.
    """

    method: ClassVar[str] = "bundle"

    def __init__(
        self,
        lens: str = AUTO,
        image_sizes: tuple[tuple[int, int], ...] | None = None,
        behind_index: float = 1.0,
        glass_index: float = GLASS,
        glass_thickness_mm: float = 10.0,
    ) -> None:
        self.lens = lens
        self.image_sizes = image_sizes
        self.behind_index = behind_index
        self.glass_index = glass_index
        self.glass_thickness_mm = glass_thickness_mm

    def fit_resected(self, X: ArrayLike, Y: ArrayLike, resected: Sequence[ResectedCamera]) -> "Bundle":
        """Fit as `fit` does, where the cameras have been resected from the same data already.

        Parameters
        ----------
        X, Y : array, (n, 2 x cameras) and (n, 3)
            Px and mm.
        resected : sequence of ResectedCamera
            By camera, with the lens and the picture sizes of this estimator.

        Raises
        ------
        InputError
            As of `fit`.
        """
        pixels, points = self._training(X, Y)
        self.single_output_, self.n_outputs_, self.own_scale_ = False, points.shape[1], np.array(1.0)
        self._keep([_known(camera) for camera in resected], points)
        self.residual_covariance_ = self._residual_covariance(pixels, points)
        return self

    def _fitted(self, q: Pixels, p: Vectors3, size: tuple[int, int]) -> FittedCamera:
        return _known(self._resected(q, p, size))

    def _resected(self, q: Pixels, p: Vectors3, size: tuple[int, int]) -> ResectedCamera:
        if self.behind_index <= 1.0:
            if self.lens == AUTO:
                return chosen_camera(self.method, q, p, size)
            return resect(self.method, q, p, camera_of_lens(self.lens, size, None))
        lens = "brown-k1k2" if self.lens == AUTO else self.lens
        kinds = [camera_of_lens(lens, size, window) for window in self._windows()]
        return resect(self.method, q, p, *kinds)

    def _windows(self) -> list[FlatWindow]:
        """Return the windows that the search begins with."""
        return [
            FlatWindow(
                distance_mm=distance,
                tilt_x_deg=tilt_x,
                tilt_y_deg=tilt_y,
                thickness_mm=self.glass_thickness_mm,
                glass_index=self.glass_index,
                behind_index=self.behind_index,
            )
            for distance in _DISTANCES_MM
            for tilt_x, tilt_y in _TILTS_DEG
        ]


def _known(resected: ResectedCamera) -> FittedCamera:
    """Return a resected camera as one whose lens formula explains all."""
    return FittedCamera(resected.placed, resected.covariance, resected.sigma_px)
