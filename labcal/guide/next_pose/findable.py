"""Poses at which the detector will find the target: in the picture, large enough, not too much tilted."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from labcal.arrays import Mask, Pose, Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.derivatives import point_derivatives
from labcal.geometry.poses import inverse, transform
from labcal.guide.next_pose.hand import HandError
from labcal.targets.catalogue import AnyTarget
from labcal.targets.grid import DotGrid

MOST_TILT_DEG = 55.0
"""Of the target's normal to the line of sight; beyond, outlines of dots and rings become slender."""
LEAST_RADIUS_PX = 4.0
"""Minor semi-axis of the image of the smallest dot."""
LEAST_CELL_PX = 14.0
"""Least pitch, across the tilt, of a target of corners."""
OUTLINE_STEPS = 8
"""Points on each side of an outline."""
_DOTS = 36
"""Dots that are looked at, about, beside those that are needed."""
_RIM = 1.35
"""Radii from a dot's centre to the edge of the picture: its outline and some board around it."""
_LEAST_SHARE = 0.6
"""Of the dots, of a target that can be numbered by a part of them."""
_SURE = 0.95
"""Share of the errors of a hand with which the target must be found."""


@dataclass(frozen=True)
class Findable:
    """The part of a target that a camera must see, so that its dots get ids.

    Attributes
    ----------
    dots : float64 array, (n, 3)
        Some of the dots, those at the edge and those that are needed among them, in the frame of the target,
        mm.
    every : int
        So many dots of the target stand behind each one of an even choice of them.
    even : bool array, (n,)
        Mask of that even choice.
    extent_mm : float64 array, (2, 2)
        Lowest and highest x and y of the print's dots, with their radii.
    radius_mm : float
        Radius of a dot; a quarter of the pitch of a target of corners.
    least_px : float
        Least minor semi-axis of its image.
    needed : bool array, (n,)
        Mask of the dots none of which may be missed.
    """

    dots: Vectors3
    every: int
    even: Mask
    extent_mm: Float64[np.ndarray, "2 2"]
    radius_mm: float
    least_px: float
    needed: Mask

    @classmethod
    def of(cls, target: AnyTarget) -> "Findable":
        """Return what of a target must be seen."""
        dots, diameters, number = target.points(), target.outer_diameters_mm(), np.arange(target.count)
        needed, radius, least = np.ones(len(dots), dtype=bool), 0.5 * float(diameters.min()), LEAST_RADIUS_PX
        if radius == 0.0:  # corners, any of which have ids by themselves
            radius, least = 0.25 * float(np.linalg.norm(dots[1] - dots[0])), 0.25 * LEAST_CELL_PX
            needed[:] = False
        elif isinstance(target, DotGrid) and target.ring_indices:
            key = [row * target.cols + col for col, row in target.ring_indices]
            needed = np.isin(number, key)
        every = max(1, round(len(dots) / _DOTS))
        even = number % every == 0
        index = target.indices()
        edge = (index == 0).any(axis=1) | (index == [target.cols - 1, target.rows - 1]).any(axis=1)
        some = even | (needed if not needed.all() else edge)
        low, high = dots[:, :2].min(axis=0) - radius, dots[:, :2].max(axis=0) + radius
        return cls(dots[some], every, even[some], np.array([low, high]), radius, least, needed[some])

    @property
    def middle(self) -> Vectors3:
        """The middle of the dots, mm."""
        return np.append(self.extent_mm.mean(axis=0), 0.0)

    def outline(self) -> Vectors3:
        """Return points along the outline of the dots, from dot (0, 0) along x, mm, (4 * steps, 3)."""
        (x0, y0), (x1, y1) = self.extent_mm
        corners = np.array([[x0, y0, 0.0], [x1, y0, 0.0], [x1, y1, 0.0], [x0, y1, 0.0]])
        along = np.arange(OUTLINE_STEPS)[:, None] / OUTLINE_STEPS
        sides = zip(corners, np.roll(corners, -1, axis=0), strict=True)
        return np.concatenate([first + along * (last - first) for first, last in sides])

    def seen(
        self, camera: Camera, T_world_target: Float64[np.ndarray, "n 4 4"]
    ) -> tuple[Bool[np.ndarray, " n"], Bool[np.ndarray, "n dots"]]:
        """Return masks of the poses at which a camera finds the target, and of the dots in full view."""
        q, size, slant = images(camera, T_world_target, self.dots, self.radius_mm)
        rim = _RIM * size.major_px
        width, height = camera.size
        inside = np.isfinite(q).all(axis=-1) & (size.minor_px > 0.0)
        with np.errstate(invalid="ignore"):
            inside &= (q[..., 0] >= rim) & (q[..., 0] <= width - 1 - rim)
            inside &= (q[..., 1] >= rim) & (q[..., 1] <= height - 1 - rim)
            large = np.where(inside, size.minor_px, np.inf).min(axis=1) >= self.least_px
        found = large & (slant <= MOST_TILT_DEG) & inside[:, self.needed].all(axis=1)
        found &= inside[:, self.even].mean(axis=1) >= _LEAST_SHARE
        return found, inside

    def sure(self, cameras: tuple[Camera, ...], T_first_target: Pose, hand: HandError) -> Mask:
        """Return a mask of the cameras that find the target when a hand takes the pose with its errors."""
        tried = hand.tried(T_first_target, self.middle)
        return np.array([self.seen(camera, tried)[0].mean() >= _SURE for camera in cameras])


@dataclass(frozen=True)
class ImageSizes:
    """Semi-axes of the images of dots, px, to first order."""

    minor_px: Float64[np.ndarray, "n dots"]
    major_px: Float64[np.ndarray, "n dots"]


def images(
    camera: Camera,
    T_world_target: Float64[np.ndarray, "n 4 4"],
    dots: Float64[np.ndarray, "dots 3"],
    radius_mm: float,
) -> tuple[Float64[np.ndarray, "n dots 2"], ImageSizes, Float64[np.ndarray, " n"]]:
    """Return the images (n, dots, 2) of dots at poses, NaN where there is none, their sizes, and tilts, deg.

    The tilt is the angle of the target's normal to the line from its middle to the camera; it is beyond 90
    where the camera looks at the back.
    """
    n = len(T_world_target)
    p = np.einsum("nij,kj->nki", T_world_target[:, :3, :3], dots) + T_world_target[:, None, :3, 3]
    image = camera.project(p)
    q = np.where((image.ok & camera.in_picture(image.q))[..., None], image.q, np.nan)
    flat = transform(camera.T_cam_world, p.reshape(-1, 3))
    with np.errstate(all="ignore"):  # of points behind the camera
        by_point = point_derivatives(camera, flat).by_point.reshape(n, len(dots), 2, 3)
    by_point = np.where(np.isfinite(q)[..., None], by_point, 0.0)
    axes = camera.T_cam_world[:3, :3] @ T_world_target[:, :3, :2]
    local = by_point @ axes[:, None]
    a = (local**2).sum(axis=(-2, -1))
    determinant = np.abs(local[..., 0, 0] * local[..., 1, 1] - local[..., 0, 1] * local[..., 1, 0])
    root = np.sqrt(np.maximum(a**2 - 4.0 * determinant**2, 0.0))
    major = radius_mm * np.sqrt(0.5 * (a + root))
    minor = radius_mm * np.sqrt(np.maximum(0.5 * (a - root), 0.0))
    eye = inverse(camera.T_cam_world)[:3, 3]
    away = eye - p.mean(axis=1)
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    cosine = np.clip((away * T_world_target[:, :3, 2]).sum(axis=1), -1.0, 1.0)
    return q, ImageSizes(minor, major), np.degrees(np.arccos(cosine))
