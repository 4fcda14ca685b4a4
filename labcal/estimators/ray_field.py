"""Rays of one camera, described by where they meet two planes."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels, Vectors3

Crossings = Float64[np.ndarray, "n 4"]
"""x, y on the near plane, then on the far one, scaled as `RayFrame` says."""


@dataclass(frozen=True)
class RayFrame:
    """The two planes: across the camera's mean view, at the two ends of the trained volume.

    Attributes
    ----------
    axes : float64 array, (3, 3)
        Rows: x and y in the planes, and the view.
    origin_mm : float64 array, (3,)
        The middle of the volume.
    depths_mm : float64 array, (2,)
        Of the near and the far plane from the origin, along the view.
    half_range_mm : float64
        What 1 means in scaled crossings.
    """

    axes: Float64[np.ndarray, "3 3"]
    origin_mm: Float64[np.ndarray, "3"]
    depths_mm: Float64[np.ndarray, "2"]
    half_range_mm: float

    @classmethod
    def of(cls, p: Vectors3, q: Pixels) -> "RayFrame":
        """Return the frame for trained points, mm, and their pixels in one camera.

        The view is the direction in which an affine camera fitted to them sees nothing move.
        """
        origin = p.mean(axis=0)
        terms = np.column_stack((p - origin, np.ones(len(p))))
        affine = np.linalg.lstsq(terms, q)[0][:3].T
        axes = np.linalg.svd(affine)[2]
        local = (p - origin) @ axes.T
        depths = np.array([local[:, 2].min(), local[:, 2].max()])
        return cls(axes, origin, depths, float(np.abs(local[:, :2]).max()))

    def first_scale(self, p: Vectors3, q: Pixels) -> Float64[np.ndarray, "n 2 2"]:
        """Return pixels per mm across the view, by the affine camera alone; the same for all points."""
        local = (p - self.origin_mm) @ self.axes.T
        terms = np.column_stack((local[:, :2], np.ones(len(p))))
        return np.broadcast_to(np.linalg.lstsq(terms, q)[0][:2].T, (len(p), 2, 2))

    def local(self, p: Vectors3) -> Vectors3:
        """Return points in the axes of the frame, mm."""
        return np.asarray((p - self.origin_mm) @ self.axes.T)

    def share(self, p: Vectors3) -> Float64[np.ndarray, " n"]:
        """Return how far points are from the near plane to the far one, 0 to 1."""
        near, far = self.depths_mm
        return np.asarray((self.local(p)[:, 2] - near) / (far - near))

    def ends(self, crossings: Crossings) -> tuple[Vectors3, Vectors3]:
        """Return where the rays meet the near and the far plane, mm."""
        scaled = self.half_range_mm * crossings
        near, far = (
            np.column_stack((scaled[:, columns], np.full(len(scaled), depth)))
            for columns, depth in zip((slice(0, 2), slice(2, 4)), self.depths_mm, strict=True)
        )
        return near @ self.axes + self.origin_mm, far @ self.axes + self.origin_mm

    def distances(self, crossings: Crossings, p: Vectors3) -> Float64[np.ndarray, "n 2"]:
        """Return the distances of rays from points, in the plane through each point, mm."""
        share = self.share(p)[:, None]
        at = (1.0 - share) * crossings[:, :2] + share * crossings[:, 2:]
        return np.asarray(self.half_range_mm * at - self.local(p)[:, :2])

    def distance_slopes(self, crossings: Crossings) -> Float64[np.ndarray, "n 2 3"]:
        """Return the derivatives of the distances by the points."""
        near, far = self.depths_mm
        along = self.half_range_mm * (crossings[:, 2:] - crossings[:, :2]) / (far - near)
        return np.asarray(along[:, :, None] * self.axes[2] - self.axes[:2])

    def distance_slopes_by_crossing(self, p: Vectors3) -> Float64[np.ndarray, "n 2 4"]:
        """Return the derivatives of the distances by the scaled crossings, mm."""
        share = self.share(p)[:, None, None]
        eye = self.half_range_mm * np.eye(2)
        return np.concatenate(((1.0 - share) * eye, share * eye), axis=2)
