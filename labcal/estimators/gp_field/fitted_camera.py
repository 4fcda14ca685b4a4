"""A camera estimated from known points, with a residual field."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property

import numpy as np
import scipy.linalg
from jaxtyping import Float64

from labcal.arrays import PixelCovariances, Pixels, Vectors3
from labcal.calibrate.resection.placed import PlacedCamera
from labcal.cameras.camera import Camera
from labcal.cameras.derivatives import Imaged, imaged
from labcal.cameras.triangulation import Imager, TriangulatedPoints, nearest_points, refined
from labcal.estimators.gp_field.pixel_field import PixelField
from labcal.estimators.gp_field.places import Places

_START_ROUNDS = 2
_SUBSTITUTIONS = 20
"""With slopes of a fifth, which is much, twenty leave 1e-14 of the field."""


class Asked(StrEnum):
    """The position in the picture at which a field is evaluated."""

    IDEAL = "ideal"
    """The image of the point by the lens formula alone."""
    ARRIVED = "arrived"
    """The true image of the point."""


@dataclass(frozen=True)
class FittedField:
    """A field, its input, and its training points, mm."""

    field: PixelField
    places: Places
    asked: Asked
    p: Vectors3


@dataclass(frozen=True)
class FittedCamera:
    """A camera with a lens formula and, if the residuals require it, a field in pixels.

    Attributes
    ----------
    placed : PlacedCamera
    covariance : float64 array, (free, free)
        Of its pose and free parameters.
    noise_px : float
        What measured pixels scatter along each axis.
    fitted : FittedField, optional
        None where the lens formula explains all.
    """

    placed: PlacedCamera
    covariance: Float64[np.ndarray, "free free"]
    noise_px: float
    fitted: FittedField | None = None

    @property
    def camera(self) -> Camera:
        """The lens formula."""
        return self.placed.camera

    def explained(self, q: Pixels, p: Vectors3) -> Pixels:
        """Return the field at pixels that see points (mm), px."""
        if self.fitted is None:
            return np.zeros_like(q)
        return self.fitted.field.at(self.inputs(self.fitted, q, p))

    def inputs(self, fitted: FittedField, q: Pixels, p: Vectors3) -> Float64[np.ndarray, "n 3"]:
        """Return the inputs of the field for points (mm) measured at pixels."""
        at = q if fitted.asked is Asked.ARRIVED else self.camera.project(p).q
        return fitted.places.inputs(self.camera, at, p)

    def project(self, p: Vectors3) -> Pixels:
        """Return the images of world points (mm), (n, 2), px; NaN where the lens has none.

        Where the field is asked where light arrives, that place is found by substitution: a field that bends
        the picture by less than its own slope converges.
        """
        q = ideal = self.camera.project(p).q
        if self.fitted is None:
            return q
        known = np.isfinite(ideal).all(axis=1)
        q = q.copy()
        for _ in range(_SUBSTITUTIONS if self.fitted.asked is Asked.ARRIVED else 1):
            q[known] = ideal[known] + self.explained(q[known], p[known])
        return q

    def pixel_covariance(self, q: Pixels, p: Vectors3, measured: PixelCovariances) -> PixelCovariances:
        """Return the covariance of predicted minus measured pixels, px squared.

        Parameters
        ----------
        q, p : ndarray, shapes (n, 2) and (n, 3)
            Measured pixels, and the points that they see, mm.
        measured : ndarray, shape (n, 2, 2)
            Covariance of the measured pixels.

        Notes
        -----
        With what was fitted as a linear model with correlated errors, this is universal kriging (Cressie
        1993, section 3.4): the field's own variance, and that of the camera's parameters as far as the field
        does not take up their errors.
        """
        seen = self.placed.seen(p).by_camera
        if self.fitted is None:
            return np.asarray(measured + seen @ self.covariance @ seen.transpose(0, 2, 1))
        field = self.fitted.field
        x = self.inputs(self.fitted, q, p)
        reach = field.reach(x)
        own = np.maximum(field.scale.amplitude_px**2 - (reach**2).sum(axis=0), 0.0)
        taken_up = (reach.T @ self._white_derivatives).reshape(seen.shape)
        J = seen - taken_up
        noise = measured
        if self.fitted.asked is Asked.ARRIVED:  # a measured pixel moves the place, too
            turn = np.eye(2) - field.slopes(x)[:, :, :2] / self.fitted.places.width_px
            noise = turn @ measured @ turn.transpose(0, 2, 1)
        return np.asarray(noise + own[:, None, None] * np.eye(2) + J @ self.covariance @ J.transpose(0, 2, 1))

    @cached_property
    def _white_derivatives(self) -> Float64[np.ndarray, "n columns"]:
        if self.fitted is None:
            return np.zeros((0, 0))
        J = self.placed.seen(self.fitted.p).by_camera
        flat = J.reshape(len(J), -1)
        return np.asarray(
            scipy.linalg.solve_triangular(self.fitted.field.root, flat, lower=True, check_finite=False)
        )


@dataclass(frozen=True)
class _Measured:
    """A camera with measured pixels; an :class:`~labcal.cameras.triangulation.Imager`.

    A field that is asked where light arrives is asked where pixels were measured: their noise moves it by
    less than it moves them.
    """

    camera: FittedCamera
    q: Pixels

    def imaged(self, p: Vectors3) -> Imaged:
        """Return the images of the points of the pixels, and their derivatives."""
        lens, fitted = self.camera.camera, self.camera.fitted
        found = imaged(lens, p)
        if fitted is None:
            return found
        places = fitted.places
        arrived = fitted.asked is Asked.ARRIVED
        x = places.inputs(lens, self.q if arrived else found.q, p)
        by_place = fitted.field.slopes(x)
        slope = by_place[:, :, 2, None] * places.depth_slopes(lens, p)[:, None, :]
        if not arrived:
            slope = slope + by_place[:, :, :2] @ found.by_point / places.width_px
        return Imaged(found.q + fitted.field.at(x), found.by_point + slope)


def measured_by(cameras: Sequence[FittedCamera], q: Float64[np.ndarray, "n cameras 2"]) -> tuple[Imager, ...]:
    """Return fitted cameras that image the points of pixels, in the order of both."""
    return tuple(_Measured(camera, q[:, number]) for number, camera in enumerate(cameras))


def triangulated(
    cameras: Sequence[FittedCamera],
    q: Float64[np.ndarray, "n cameras 2"],
    covariance: Float64[np.ndarray, "n cameras 2 2"],
) -> TriangulatedPoints:
    """Return the points whose images are nearest to pixels, with the covariance of the estimated cameras.

    Parameters
    ----------
    cameras : sequence of FittedCamera
        At least two, in the order of `q`.
    q : ndarray, shape (n, cameras, 2)
        Pixels of the same points.
    covariance : ndarray, shape (n, cameras, 2, 2)
        Their covariances, px squared.
    """
    imagers = measured_by(cameras, q)
    found = refined(imagers, _start(cameras, q), q, covariance)
    p = np.where(found.ok[:, None], found.point, 0.0)
    total = np.stack(
        [camera.pixel_covariance(q[:, i], p, covariance[:, i]) for i, camera in enumerate(cameras)], axis=1
    )
    return refined(imagers, found.point, q, total)


def _start(cameras: Sequence[FittedCamera], q: Float64[np.ndarray, "n cameras 2"]) -> Vectors3:
    """Return the points nearest to the rays of pixels after subtraction of the field."""
    lenses = [camera.camera for camera in cameras]
    middle = np.mean([camera.placed.middle for camera in cameras], axis=0)
    p = np.tile(middle, (len(q), 1))
    for _ in range(_START_ROUNDS):
        straight = [q[:, i] - camera.explained(q[:, i], p) for i, camera in enumerate(cameras)]
        found = nearest_points(lenses, np.stack(straight, axis=1))
        p = np.where(np.isfinite(found), found, p)
    return p
