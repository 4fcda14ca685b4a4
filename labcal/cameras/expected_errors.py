"""Errors to expect of points that a rig measures: in depth and sideways, by noise and by the calibration."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot, isfinite

import numpy as np
from jaxtyping import Float64

from labcal.arrays import PointCovariances, Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.triangulation import triangulation_limit
from labcal.cameras.triangulation_derivatives import triangulation_derivatives
from labcal.geometry.rigid_part import without_rigid_part

_MOST_PLACES = 1500
"""Places that the errors are means of: more add nothing."""
_PAIR, _NAN = 2, float("nan")


@dataclass(frozen=True)
class ErrorShares:
    """Standard deviations along one direction by source, root mean squares over places.

    Attributes
    ----------
    noise_mm : float
        By the noise of pixels.
    calibration_mm : float
        By the calibration; NaN where the rig does not state its covariance.
    print_mm : float
        The part of it by dots that are off on the print; NaN where that is not told apart.
    """

    noise_mm: float
    calibration_mm: float
    print_mm: float = _NAN

    @property
    def total_mm(self) -> float:
        """Both together; the noise alone where the calibration's share is not known."""
        return hypot(self.noise_mm, self.calibration_mm if isfinite(self.calibration_mm) else 0.0)


@dataclass(frozen=True)
class ExpectedErrors:
    """Errors to expect at places that all cameras see.

    Attributes
    ----------
    distance_mm, nearest_mm, farthest_mm : float
        Median, least and greatest distance from the middle between the cameras; NaN without such a place.
    pixel_sigma_px : float
        Standard deviation of a pixel along each axis, mean square over the cameras.
    depth, sideways : ErrorShares
        Along the direction of view, and along one axis across it, in the frame of the rig; NaN in depth of a
        single camera.
    shape_mm : float
        RMS 3-D error by the calibration that is left after a rigid motion, which shapes and lengths do not
        notice; NaN where it is not known.
    """

    distance_mm: float
    nearest_mm: float
    farthest_mm: float
    pixel_sigma_px: float
    depth: ErrorShares
    sideways: ErrorShares
    shape_mm: float


def expected_errors(
    cameras: Sequence[Camera],
    parameters: Float64[np.ndarray, "parameters parameters"] | None,
    places: Vectors3,
    pixel_sigma_px: Sequence[float],
) -> ExpectedErrors:
    """Return the errors to expect of points at places like these.

    Parameters
    ----------
    cameras : sequence of Camera
        One or more; the first one is the world.
    parameters : ndarray or None
        Their joint covariance in the order of ``rig.json``.
    places : ndarray, shape (n, 3)
        Mm, in the world; those that a camera does not see are left out.
    pixel_sigma_px : sequence of float
        Standard deviation of pixels along each axis, by camera.
    """
    seen = np.all([camera.in_picture(camera.project(places).q) for camera in cameras], axis=0)
    p = places[seen]
    noise = float(np.sqrt(np.square(pixel_sigma_px).mean()))
    if len(p) == 0:
        none = ErrorShares(_NAN, _NAN)
        return ExpectedErrors(_NAN, _NAN, _NAN, noise, none, none, _NAN)
    middle = np.mean([camera.centre for camera in cameras], axis=0)
    distance = np.linalg.norm(p - middle, axis=1)
    far = (float(np.median(distance)), float(distance.min()), float(distance.max()))
    some = slice(None, None, -(-len(p) // _MOST_PLACES))
    p, direction = p[some], (p - middle)[some] / distance[some, None]
    if len(cameras) < _PAIR:
        (camera,) = cameras
        scale = float(np.mean([camera.K[0, 0], camera.K[1, 1]]))  # of parallel rays px/mm
        across = noise / scale * (1.0 if camera.model.parallel else far[0])
        return ExpectedErrors(*far, noise, ErrorShares(_NAN, _NAN), ErrorShares(across, _NAN), _NAN)
    pixels = np.tile(np.eye(2), (len(p), len(cameras), 1, 1))
    pixels *= np.square(np.maximum(pixel_sigma_px, 1e-6))[:, None, None]
    by_noise = _depth_and_sideways(triangulation_limit(cameras, p, pixels), direction)
    by_calibration, shape = (_NAN, _NAN), _NAN
    if parameters is not None:
        by = triangulation_derivatives(cameras, p, pixels)
        by_calibration = _depth_and_sideways(by @ parameters @ by.transpose(0, 2, 1), direction)
        shape = _shape_mm(by, parameters, p)
    depth, sideways = map(ErrorShares, by_noise, by_calibration)
    return ExpectedErrors(*far, noise, depth, sideways, shape)


def _depth_and_sideways(
    covariance: PointCovariances, direction: Float64[np.ndarray, "n 3"]
) -> tuple[float, float]:
    """Return RMS standard deviations along directions, and along one axis across them, mm."""
    along = np.einsum("ni,nij,nj->n", direction, covariance, direction)
    across = 0.5 * (np.trace(covariance, axis1=1, axis2=2) - along)
    known = np.isfinite(along)
    if not known.any():
        return _NAN, _NAN
    return float(np.sqrt(along[known].mean())), float(np.sqrt(across[known].mean()))


def _shape_mm(
    by: Float64[np.ndarray, "n 3 parameters"],
    parameters: Float64[np.ndarray, "parameters parameters"],
    p: Vectors3,
) -> float:
    """Return the RMS 3-D error that a rigid motion of all points leaves, mm."""
    known = np.isfinite(by).all(axis=(1, 2))
    p, n = p[known], int(known.sum())
    if n < 3:  # noqa: PLR2004 -- fewer have no shape
        return _NAN
    left = without_rigid_part(by[known], p).reshape(3 * n, -1)
    return float(np.sqrt(max(0.0, float(((left @ parameters) * left).sum())) / n))
