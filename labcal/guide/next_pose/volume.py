"""The volume in which points will be measured, and the errors of points there."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Matrix3, Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.derivatives import imaged
from labcal.cameras.parameter_derivatives import parameter_count, parameter_derivatives
from labcal.cameras.triangulation import KnownCamera, noise_covariance
from labcal.cameras.triangulation_derivatives import triangulation_derivatives
from labcal.geometry.rigid_part import without_rigid_part

_CELLS = (6, 5, 4)
"""Points across, upright and in depth."""
_SHARES = np.linspace(0.02, 1.0, 50)


@dataclass(frozen=True)
class MeasuredVolume:
    """Points of a box that all cameras see; the world is the first camera's frame.

    Attributes
    ----------
    cameras : tuple of Camera
    points : float64 array, (n, 3)
        Mm.
    """

    cameras: tuple[Camera, ...]
    points: Vectors3

    @classmethod
    def of(
        cls, cameras: tuple[Camera, ...], centre: Vectors3, sides_mm: tuple[float, ...] | None
    ) -> "MeasuredVolume":
        """Return a box about a place: depth runs away from the middle of the cameras.

        Parameters
        ----------
        cameras : tuple of Camera
        centre : ndarray, shape (3,)
            Mm.
        sides_mm : tuple of three floats, or None
            Across, upright and in depth; what all cameras see at that distance, and as deep as the smaller
            of both, where None.
        """
        axes = _axes(cameras, centre)
        if sides_mm is None:
            across, upright = (_reach(cameras, centre, axis) for axis in axes[:2])
            sides_mm = (2.0 * across, 2.0 * upright, 2.0 * min(across, upright))
        steps = [np.linspace(-0.5, 0.5, count) * side for count, side in zip(_CELLS, sides_mm, strict=True)]
        grid = np.stack(np.meshgrid(*steps, indexing="ij"), axis=-1).reshape(-1, 3)
        return cls(cameras, centre + grid @ axes).seen()

    def seen(self) -> "MeasuredVolume":
        """Return the volume without the points that a camera does not see."""
        inside = [camera.project(self.points) for camera in self.cameras]
        ok = [one.ok & camera.in_picture(one.q) for one, camera in zip(inside, self.cameras, strict=True)]
        return MeasuredVolume(self.cameras, self.points[np.all(ok, axis=0)])

    @cached_property
    def square_by_parameters(self) -> Float64[np.ndarray, "parameters parameters"]:
        """M of the mean squared error tr(M C) of points by a calibration with the covariance C, mm squared.

        Of a single camera: of the place across its line of sight.
        """
        if len(self.points) == 0:
            return np.zeros((parameter_count(self.cameras),) * 2)
        if len(self.cameras) == 1:
            found = parameter_derivatives(self.cameras[0], self.points)
            lens = found.by_parameters[..., : parameter_count(self.cameras)]
            by = -np.linalg.pinv(found.by_point) @ lens
        else:
            by = triangulation_derivatives(self.cameras, self.points, self._pixels(1.0))
        return np.asarray(np.einsum("nki,nkj->ij", by, by) / len(self.points))

    @property
    def shape_by_parameters(self) -> Float64[np.ndarray, "parameters parameters"]:
        """The same of points that are brought onto the truth by a rigid motion; of two cameras or more."""
        by = triangulation_derivatives(self.cameras, self.points, self._pixels(1.0))
        by = without_rigid_part(by, self.points)
        return np.asarray(np.einsum("nki,nkj->ij", by, by) / len(self.points))

    def noise_mm(self, variance_px2: float) -> float:
        """Return the RMS error of a point by the noise of its own pixels, of this variance, mm."""
        if len(self.points) == 0:
            return float("nan")
        if len(self.cameras) == 1:
            across = np.linalg.pinv(imaged(self.cameras[0], self.points).by_point)
            return float(np.sqrt(variance_px2 * (across**2).sum(axis=(1, 2)).mean()))
        imagers = [KnownCamera(camera) for camera in self.cameras]
        covariance = noise_covariance(imagers, self.points, self._pixels(variance_px2), 0.0)
        return float(np.sqrt(np.trace(covariance, axis1=1, axis2=2).mean()))

    def _pixels(self, variance_px2: float) -> Float64[np.ndarray, "n cameras 2 2"]:
        return np.tile(variance_px2 * np.eye(2), (len(self.points), len(self.cameras), 1, 1))


def middle_of_eyes(cameras: tuple[Camera, ...]) -> Vectors3:
    """Return the middle of the cameras' centres, mm."""
    return np.asarray(np.mean([camera.centre for camera in cameras], axis=0))


def _axes(cameras: tuple[Camera, ...], centre: Vectors3) -> Matrix3:
    """Return unit vectors to the right of the first camera's picture, down, and away from the cameras."""
    away = centre - middle_of_eyes(cameras)
    away /= np.linalg.norm(away)
    right = cameras[0].T_cam_world[0, :3] - (cameras[0].T_cam_world[0, :3] @ away) * away
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(away, right), away])


def _reach(cameras: tuple[Camera, ...], centre: Vectors3, axis: Vectors3) -> float:
    """Return how far along an axis, to both sides of a place, all cameras see, mm."""
    most = float(np.linalg.norm(centre - middle_of_eyes(cameras)))
    reach = most * _SHARES
    seen = np.ones(len(reach), dtype=bool)
    for camera in cameras:
        for side in (-1.0, 1.0):
            image = camera.project(centre + side * reach[:, None] * axis)
            seen &= image.ok & camera.in_picture(image.q)
    return float(reach[np.cumprod(seen).astype(bool)].max(initial=_SHARES[0] * most))
