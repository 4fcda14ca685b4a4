"""The error budget of reconstructed points: noise of their pixels, and the calibration that they share."""

from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property

import numpy as np
from jaxtyping import Float64

from labcal.arrays import AnyArray, PointCovariances, Vectors3, lines_array
from labcal.cameras.calibration_share import calibration_share
from labcal.cameras.camera import Camera
from labcal.cameras.parameter_derivatives import parameter_count
from labcal.cameras.rig import Rig
from labcal.cameras.triangulation import KnownCamera, noise_covariance
from labcal.cameras.triangulation_derivatives import triangulation_derivatives
from labcal.errors import InputError
from labcal.reconstruct.point_errors import PointErrors


class Budget(StrEnum):
    """The sources of errors that the covariances of points contain."""

    FULL = "full"
    """Noise of pixels, the variance component of the calibration's residuals, and the calibration."""
    NOISE = "noise"
    """Noise of pixels alone, by their own covariances; the cameras count as exact."""


@dataclass(frozen=True, eq=False)
class PointBudget:
    """Both shares of the errors of points of one rig.

    Errors by noise are a point's own; errors of the calibration move all points together, so that distances
    and shapes are known better, or worse, than single points tell (:meth:`joint`).

    Attributes
    ----------
    cameras : tuple of Camera
        In the order of the pixels; the first one is the world.
    parameters : float64 array, (parameters, parameters)
        Joint covariance of the cameras' parameters, in the order of ``rig.json``.
    point : float64 array, (n, 3)
        Mm.
    pixels : float64 array, (n, cameras, 2, 2)
        Covariances of the pixels by which the points were triangulated, px squared; NaN of cameras that took
        no part in a point.
    noise : float64 array, (n, 3, 3)
        Share of the pixels' noise with the variance component, mm squared.
    kind : Budget
        Of noise alone, `parameters` are zeros.
    """

    cameras: tuple[Camera, ...]
    parameters: Float64[np.ndarray, "parameters parameters"]
    point: Vectors3
    pixels: Float64[np.ndarray, "n cameras 2 2"]
    noise: PointCovariances

    kind: Budget

    @classmethod
    def of(
        cls, rig: Rig, point: Vectors3, pixels: Float64[np.ndarray, "n cameras 2 2"], wanted: Budget | None
    ) -> "PointBudget":
        """Return the budget of points that a rig triangulated.

        Parameters
        ----------
        rig : Rig
        point : ndarray, shape (n, 3)
            Mm; NaN where there is none.
        pixels : ndarray, shape (n, cameras, 2, 2)
            Px squared, by which the points were triangulated; NaN of cameras that took no part in a point.
        wanted : Budget or None
            None for all that the rig knows.

        Raises
        ------
        InputError
            The full budget is wanted of a rig that states no covariance.
        """
        if wanted is Budget.FULL and rig.covariance is None:
            raise InputError(
                "This rig states no covariance of its calibration, so that the budget of its points is that "
                "of noise alone. Calibrate again to know more, or leave `budget` out."
            )
        cameras = tuple(rig.camera(name) for name in rig.cameras)
        kind = Budget.NOISE if rig.covariance is None else wanted or Budget.FULL
        imagers, extra = [KnownCamera(camera) for camera in cameras], 0.0
        parameters = np.zeros((parameter_count(cameras), parameter_count(cameras)))
        if kind is Budget.FULL and rig.covariance is not None:
            extra = 0.0 if rig.calibration is None else (rig.calibration.scatter_px or 0.0) ** 2
            parameters = rig.covariance.matrix
        noise = noise_covariance(imagers, point, pixels, extra)
        return cls(cameras, parameters, point, pixels, noise, kind)

    def __len__(self) -> int:
        return len(self.point)

    def derivatives(self, lines: AnyArray) -> Float64[np.ndarray, "k 3 parameters"]:
        """Return the derivatives of some points by the cameras' parameters; `lines` as of :meth:`joint`."""
        lines = lines_array(lines, len(self), "lines")
        return triangulation_derivatives(self.cameras, self.point[lines], self.pixels[lines])

    @cached_property
    def calibration(self) -> PointCovariances:
        """The share of the calibration in the covariance of each point, (n, 3, 3), mm squared."""
        if self.kind is Budget.NOISE:
            return np.zeros_like(self.noise)
        return calibration_share(self.cameras, self.parameters, self.point, self.pixels)

    def joint(self, lines: AnyArray) -> Float64[np.ndarray, "coordinates coordinates"]:
        """Return the joint covariance of some points, (3 k, 3 k), mm squared: x, y, z point by point.

        Parameters
        ----------
        lines : array_like of int, shape (k,), or of bool, shape (n,)
            Numbers of the points in their table, or a mask.

        Raises
        ------
        InputError, InputTypeError
            There is no such line.
        """
        return self.errors(lines).joint

    def errors(self, lines: AnyArray) -> PointErrors:
        """Return the sources of the errors of some points; `lines` as of :meth:`joint`."""
        lines = lines_array(lines, len(self), "lines")
        return PointErrors.without_shared_noise(self.noise[lines], self.derivatives(lines), self.parameters)


def budget_of_a_method() -> InputError:
    """Return the error for a budget that is named for a fitted method."""
    return InputError(
        "`budget` is for points of a rig; a fitted method states the covariance of its points itself. "
        "Leave `budget` out."
    )
