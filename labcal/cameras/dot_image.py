"""The image of a circular dot: where its centre, its outline and the centroid of its area fall.

The centroid of a projected disc is not the projection of its centre (the "eccentricity" of Ahn, Warnecke
and Kotowski 1999); lens distortion moves it further. Here both follow from the outline, for any camera.
"""

from dataclasses import dataclass

import numpy as np

from labcal.arrays import Mask, Outlines, Pixels, Points, Pose
from labcal.cameras.camera import Camera
from labcal.geometry.poses import transform

SAMPLES = 64
"""Points on an outline; on a smooth closed curve the trapezoidal rule converges exponentially."""


@dataclass(frozen=True)
class DotImages:
    """Images of n dots in one picture, px; NaN where any part cannot be imaged."""

    centre: Pixels
    """(n, 2), the image of the dot's centre."""
    centroid: Pixels
    """(n, 2), the centre of area of the image of its outline."""
    outline: Outlines
    """(n, SAMPLES, 2), the outline from the target's +x direction towards +y."""
    ok: Mask
    """(n,), whether the whole dot is imaged."""


def dot_images(camera: Camera, T_world_target: Pose, centres: Points, radii: np.ndarray) -> DotImages:
    """Return where dots of a flat target are imaged.

    Parameters
    ----------
    camera : Camera
    T_world_target : ndarray, shape (4, 4)
        Pose of the target, mm.
    centres : ndarray, shape (n, 3)
        Centres of the dots in the target's frame, mm; the discs lie parallel to its x-y plane.
    radii : ndarray, shape (n,)
        Radii of the outer outlines, mm.

    Notes
    -----
    With the outline (x(t), y(t)), Green's theorem gives the area as half the integral of x dy - y dx and the
    centroid as the integrals of x^2 dy / 2 and -y^2 dx / 2 over the area.
    """
    angle = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES
    circle = np.stack([np.cos(angle), np.sin(angle), np.zeros(SAMPLES)], axis=-1)
    tangent = np.stack([-np.sin(angle), np.cos(angle), np.zeros(SAMPLES)], axis=-1)
    radius = radii[:, None, None]
    p = transform(T_world_target, centres[:, None, :] + radius * circle)
    dp = radius * tangent @ T_world_target[:3, :3].T

    middle = camera.project(transform(T_world_target, centres))
    edge = camera.project(p)
    ok = middle.ok & edge.ok.all(axis=-1)
    offset = edge.q - middle.q[:, None, :]  # about the centre, where no digits are lost
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        dq = np.einsum("nsij,nsj->nsi", camera.point_jacobian(p), dp)
        x, y = offset[..., 0], offset[..., 1]
        dx, dy = dq[..., 0], dq[..., 1]
        area = 0.5 * (x * dy - y * dx).sum(axis=-1)
        first = np.stack([0.5 * (x * x * dy).sum(axis=-1), -0.5 * (y * y * dx).sum(axis=-1)], axis=-1)
        centroid = middle.q + first / area[:, None]
    keep = ok[:, None]
    return DotImages(
        centre=middle.q,
        centroid=np.where(keep, centroid, np.nan),
        outline=np.where(keep[..., None], edge.q, np.nan),
        ok=ok,
    )
