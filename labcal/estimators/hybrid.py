"""Cameras resected from known points, with a residual field in pixels."""

import itertools
from typing import ClassVar

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels, Vectors3
from labcal.calibrate.lens_candidates import AUTO, OF_POINTS
from labcal.calibrate.resection.interface import resect_through_interface
from labcal.calibrate.resection.lens_choice import camera_of_lens, chosen_camera
from labcal.calibrate.resection.resected import ResectedCamera, resect
from labcal.errors import InputError
from labcal.estimators.camera_estimator import CameraEstimator
from labcal.estimators.gp_field.fitted_camera import FittedCamera
from labcal.estimators.gp_field.learning import fitted_camera
from labcal.estimators.gp_field.leave_one_out import log_predictive_density
from labcal.estimators.gp_field.stage_moves import StageMoves

_SIMPLER = OF_POINTS[:2]
"""Lens formulas that are tried below a field, in place of one with more coefficients."""
MOST_POINTS = 4000
"""The field's covariance is a full matrix of the trained points."""


class Hybrid(CameraEstimator):
    """The method ``hybrid``: `bundle`, and a Gaussian process in pixels over place and depth.

    A camera's pixels are those of a lens formula plus a smooth field over the place in the picture and one
    over the distance. Where the lens formula is right, the data ask for no field and the method is `bundle`;
    where it is not, wavy glass or water say, the field explains the rest (Rasmussen and Williams 2006,
    section 2.7, on explicit basis functions).

    Parameters
    ----------
    lens : str
        The lens formula: a model, the name or file of a prescription, or ``auto``: the simplest model that
        predicts held-out dots as well as any; below a field, the one of it and two simpler ones with which
        dots are predicted best by the others.
    image_sizes : tuple of (int, int), optional
        Width and height, px, of each camera's pictures. Where left out, pictures reach as far as the trained
        pixels.

    Attributes
    ----------
    cameras_ : tuple of Camera
        The lens formulas, in the order of the columns.
    field_px_ : float64 array, (cameras,)
        What the field explains of the trained pixels, root mean square of its length; 0 where there is none.
    resected_ : tuple of ResectedCamera
        The cameras before a field was estimated: those of `bundle`. Not kept in a model file.
    """

    method: ClassVar[str] = "hybrid"

    def __init__(self, lens: str = AUTO, image_sizes: tuple[tuple[int, int], ...] | None = None) -> None:
        self.lens = lens
        self.image_sizes = image_sizes

    @property
    def field_px_(self) -> np.ndarray:
        """RMS length of the field at training pixels, px, by camera."""
        return np.array(
            [
                0.0
                if camera.fitted is None
                else float(np.sqrt((camera.fitted.field.smoothed() ** 2).sum(axis=1).mean()))
                for camera in self.fitted_cameras_
            ]
        )

    moves: StageMoves | None = None
    """Errors of a stage that the training points come from, while :meth:`fit_on_stage` is at work."""

    def fit_on_stage(
        self,
        X: Float64[np.ndarray, "n inputs"],
        y: Float64[np.ndarray, "n outputs"],
        moves: StageMoves | None,
    ) -> "Hybrid":
        """Fit to points of a stage with stated errors, which the field then does not explain.

        Parameters
        ----------
        X : ndarray, shape (n, 2 x cameras)
            Px.
        y : ndarray, shape (n, 3)
            Mm.
        moves : StageMoves or None
            By point; None where the stage's errors are not stated.
        """
        self.moves = moves
        try:
            self.fit(X, y)
        finally:
            self.moves = None
        return self

    def _fit(self, pixels: Float64[np.ndarray, "n inputs"], points: Float64[np.ndarray, "n outputs"]) -> None:
        self.resected_: tuple[ResectedCamera, ...] = ()
        super()._fit(pixels, points)

    def _fitted(self, q: Pixels, p: Vectors3, size: tuple[int, int]) -> FittedCamera:
        if len(p) > MOST_POINTS:
            raise InputError(
                f"{self.method}: {len(p)} dots are more than the {MOST_POINTS} that a field can be fitted "
                "from. Train on fewer views, or use 'bundle'."
            )
        if self.lens == AUTO:
            start = chosen_camera(self.method, q, p, size)
        else:
            start = resect(self.method, q, p, camera_of_lens(self.lens, size, None))
        self.resected_ = (*self.resected_, start)
        found = fitted_camera(start, q, p, self.moves)
        if self.lens != AUTO or found.fitted is None:
            return found
        return self._simplified(found, start, q, p)

    def _simplified(self, found: FittedCamera, start: ResectedCamera, q: Pixels, p: Vectors3) -> FittedCamera:
        """Return the likeliest of a camera with a field and those with a simpler lens formula.

        The coefficients that predict held-out dots best without a field may stand in its way. The simpler
        formulas are tried behind an interface, too, as to water; one that needs no field ends the search.
        """
        known, best = log_predictive_density(found, q, p), found
        in_air: list[ResectedCamera] = []
        for lens in _SIMPLER:
            if lens == start.camera.lens:
                in_air.append(start)
            else:
                kind = camera_of_lens(lens, start.camera.size, None)
                try:
                    in_air.append(resect(self.method, q, p, kind))
                except InputError:  # too far off to begin with
                    continue
            behind = resect_through_interface(q, p, in_air[-1])
            if behind is None:
                continue
            camera = fitted_camera(behind, q, p, self.moves)
            density = log_predictive_density(camera, q, p)
            if density > known:
                known, best = density, camera
                if camera.fitted is None:
                    return camera
        for simpler in itertools.takewhile(lambda one: one.camera.lens != found.camera.lens, in_air):
            camera = fitted_camera(simpler, q, p, self.moves)
            density = log_predictive_density(camera, q, p)
            if density > known:
                known, best = density, camera
        return best
