"""A camera in a few words."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from labcal.cameras.camera import Camera


def camera_description(camera: "Camera") -> Mapping[str, str]:
    """Return lens, picture size, focal length and angle of view, for people."""
    fx, fy, _, _ = camera.intrinsics
    width, height = camera.size
    across, down = field_deg(camera)
    return {
        "lens": camera.lens,
        "size": f"{width} x {height} px",
        "focal_length": f"{fx:.1f}, {fy:.1f} px",
        "field": f"{across:.1f} x {down:.1f} deg",
    }


def field_deg(camera: "Camera") -> tuple[float, float]:
    """Return the angles of view from edge to edge through the picture's middle, across and down, degrees."""
    width, height = camera.size
    u, v = 0.5 * (width - 1), 0.5 * (height - 1)
    edges = camera.rays([[-0.5, v], [width - 0.5, v], [u, -0.5], [u, height - 0.5]]).direction
    x, y, z = camera.T_cam_world[:3, :3] @ edges.T
    left, right = np.degrees(np.arctan2(x[:2], z[:2])).tolist()
    top, bottom = np.degrees(np.arctan2(y[2:], z[2:])).tolist()
    return right - left, bottom - top
