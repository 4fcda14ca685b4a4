"""Cost of a change of a rig in mm: errors of points over a volume, if the old calibration is used."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Vectors3
from labcal.calibrate.adjustment.state import RigState
from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.cameras.triangulation import triangulate
from labcal.cameras.triangulation_derivatives import triangulation_derivatives
from labcal.geometry.poses import transform
from labcal.reconstruct.point_budget import PointBudget

_STEPS = 6
"""Points along each edge of the volume."""
_CAMERAS = 2
_MOST = 400
"""Points at which errors are computed, at most."""


@dataclass(frozen=True)
class Volume:
    """Points of the volume that the target took up in the pictures, and the budget of points there.

    Attributes
    ----------
    rig : Rig
    points : float64 array, (n, 3)
        World of the rig, mm; those that all cameras image.
    pixels : float64 array, (n, cameras, 2, 2)
        Covariances of pixels, px squared.
    low_mm, high_mm : float64 array, (3,)
        Corners.
    """

    rig: Rig
    points: Vectors3
    pixels: Float64[np.ndarray, "n cameras 2 2"]
    low_mm: Float64[np.ndarray, " 3"]
    high_mm: Float64[np.ndarray, " 3"]

    @classmethod
    def of(cls, rig: Rig, state: RigState, noise: Float64[np.ndarray, "2 2"]) -> "Volume | None":
        """Return the volume of the target's dots in all views; None if no two cameras see any of it.

        Parameters
        ----------
        rig : Rig
        state : RigState
            With the poses of the target.
        noise : ndarray, shape (2, 2)
            Covariance of a pixel, px squared.
        """
        places = np.concatenate([transform(T, state.dots) for T in state.T_world_target])
        return cls.around(rig, places, noise)

    @classmethod
    def around(cls, rig: Rig, dots: Vectors3, noise: Float64[np.ndarray, "2 2"]) -> "Volume | None":
        """Return the volume around points in the world, mm; None if no two cameras see any of it.

        Parameters
        ----------
        rig : Rig
        dots : ndarray, shape (n, 3)
        noise : ndarray, shape (2, 2)
            Covariance of a pixel, px squared.
        """
        low, high = dots.min(axis=0), dots.max(axis=0)
        axes = [np.linspace(first, last, _STEPS) for first, last in zip(low, high, strict=True)]
        grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        return cls._seen(rig, grid, noise, (low, high))

    @classmethod
    def at(cls, rig: Rig, dots: Vectors3, noise: Float64[np.ndarray, "2 2"]) -> "Volume | None":
        """Return the volume as sampled by the dots themselves, mm; None if no two cameras see any of it.

        Parameters
        ----------
        rig : Rig
        dots : ndarray, shape (n, 3)
            Some of them are taken where there are many.
        noise : ndarray, shape (2, 2)
            Covariance of a pixel, px squared.
        """
        some = dots[:: -(-len(dots) // _MOST)]
        return cls._seen(rig, some, noise, (dots.min(axis=0), dots.max(axis=0)))

    @classmethod
    def _seen(
        cls,
        rig: Rig,
        points: Vectors3,
        noise: Float64[np.ndarray, "2 2"],
        corners: tuple[Float64[np.ndarray, " 3"], Float64[np.ndarray, " 3"]],
    ) -> "Volume | None":
        """Return the volume of those points that all cameras image."""
        cameras = _cameras(rig)
        if len(cameras) < _CAMERAS:
            return None
        for camera in cameras:
            seen = camera.project(points)
            points = points[seen.ok & camera.in_picture(seen.q)]
        if len(points) == 0:
            return None
        pixels = np.tile(noise, (len(points), len(cameras), 1, 1))
        return cls(rig, points, pixels, *corners)

    def budget_mm(self) -> float:
        """Return the RMS standard deviation of a point by noise and calibration."""
        budget = PointBudget.of(self.rig, self.points, self.pixels, None)
        variance = np.trace(budget.noise + budget.calibration, axis1=1, axis2=2)
        return float(np.sqrt(variance.mean()))

    def errors_mm(self, cameras: tuple[Camera, ...]) -> Vectors3:
        """Return the errors of points whose pixels come from changed cameras and that the rig reconstructs.

        In the world of the changed first camera; NaN where there is no point.
        """
        q = np.stack([camera.project(self.points).q for camera in cameras], axis=1)
        found = triangulate(_cameras(self.rig), np.nan_to_num(q, nan=-1e6), self.pixels)
        return np.where(np.isfinite(q).all(axis=(1, 2))[:, None], found.point - self.points, np.nan)

    def square_by_parameters(self) -> Float64[np.ndarray, "shared shared"]:
        """Return M of the mean squared error x' M x of points by a small change x of the rig's parameters."""
        by = triangulation_derivatives(_cameras(self.rig), self.points, self.pixels)
        by = by[np.isfinite(by).all(axis=(1, 2))]
        return np.asarray(np.einsum("nki,nkj->ij", by, by) / max(1, len(by)))


def _cameras(rig: Rig) -> list[Camera]:
    return [rig.camera(name) for name in rig.cameras]
