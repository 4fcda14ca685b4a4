"""The inputs of a field: position in the picture, and inverse distance of the point."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels, Vectors3
from labcal.cameras.camera import Camera
from labcal.geometry.poses import transform


@dataclass(frozen=True)
class Places:
    """The scaling of the inputs of a field: pixels by picture width, and inverse distance.

    The rays of a camera that is not central (behind glass, say) differ with the distance, the less the
    farther away: one over the distance is what they are nearly linear in.

    Attributes
    ----------
    width_px : float
    farthest : float
        One over the largest trained distance from the camera's centre, 1/mm.
    span : float
        What the nearest trained distance is beyond that, 1/mm.
    """

    width_px: float
    farthest: float
    span: float

    @classmethod
    def of(cls, camera: Camera, p: Vectors3) -> "Places":
        """Return the scaling for trained points, mm."""
        nearness = _nearness(camera, p)
        low, high = float(nearness.min()), float(nearness.max())
        return cls(float(camera.size[0]), low, high - low if high > low else low)

    def inputs(self, camera: Camera, q: Pixels, p: Vectors3) -> Float64[np.ndarray, "n 3"]:
        """Return the inputs of points, mm, that are seen at pixels."""
        nearness = (_nearness(camera, p) - self.farthest) / self.span
        return np.column_stack([q / self.width_px, nearness])

    def depth_slopes(self, camera: Camera, p: Vectors3) -> Float64[np.ndarray, "n 3"]:
        """Return the derivative of the third input by the point, 1/mm."""
        T = camera.T_cam_world
        p_cam = transform(T, p)
        cubed = ((p_cam**2).sum(axis=1) ** 1.5)[:, None]
        return np.asarray(-(p_cam @ T[:3, :3]) / cubed / self.span)


def _nearness(camera: Camera, p: Vectors3) -> np.ndarray:
    return np.asarray(1.0 / np.linalg.norm(transform(camera.T_cam_world, p), axis=1))
