"""A figure of a rig: its cameras in space."""

from itertools import combinations

import numpy as np
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.axes3d import Axes3D

from labcal.arrays import Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig

_LONG = 0.6
"""Of the greatest distance between two cameras: length of the rays that are drawn."""
_ALONE_MM = 100.0
"""Length of the rays of a camera that stands alone."""


def rig_figure(rig: Rig) -> Figure:
    """Draw the cameras of a rig in their world; see :meth:`~labcal.cameras.rig.Rig.plot`.

    The axes are turned so that the world's y, which is down in a rig from a hand-held target, is down.
    """
    cameras = {name: rig.camera(name) for name in rig.cameras}
    baselines = {pair: rig.baseline_mm(*pair) for pair in combinations(cameras, 2)}
    long = _LONG * max(baselines.values(), default=0.0) or _ALONE_MM
    figure = Figure(figsize=(7.0, 5.5), layout="constrained")
    axes: Axes3D = figure.add_subplot(projection="3d")
    drawn = []
    for number, (name, camera) in enumerate(cameras.items()):
        colour = f"C{number}"
        corners = _corners(camera, long)
        for corner in corners[:-1]:
            _line(axes, [camera.centre, corner], colour)
        _line(axes, corners, colour)
        x, y, z = camera.centre.tolist()
        axes.scatter([x], [z], [y], color=colour, label=f"{name} ({camera.lens})")
        drawn += [camera.centre, *corners]
    for (first, second), length in baselines.items():
        ends = [cameras[first].centre, cameras[second].centre]
        _line(axes, ends, "0.4", style="--")
        x, y, z = np.mean(ends, axis=0).tolist()
        axes.text(x, z, y, f"{length:.1f} mm")
    _set_equal(axes, np.array(drawn))
    axes.set_xlabel("X (mm)")
    axes.set_ylabel("Z (mm)")
    axes.set_zlabel("Y (mm)")
    axes.view_init(elev=25.0, azim=-60.0)
    axes.legend(loc="upper left")
    axes.set_title("Cameras in the world, with their fields of view")
    return figure


def _corners(camera: Camera, long: float) -> Vectors3:
    """Return points on the rays of the picture's corners, the first one again at the end, mm."""
    right, bottom = camera.size[0] - 0.5, camera.size[1] - 0.5
    q = [[-0.5, -0.5], [right, -0.5], [right, bottom], [-0.5, bottom], [-0.5, -0.5]]
    rays = camera.rays(q)
    return rays.origin + long * rays.direction


def _line(axes: Axes3D, points: Vectors3 | list[Vectors3], colour: str, style: str = "-") -> None:
    """Draw a line through points of the world; y of the world is upright in the figure."""
    X, Y, Z = np.transpose(points)
    axes.plot(X, Z, Y, color=colour, linestyle=style, linewidth=1.2)


def _set_equal(axes: Axes3D, points: Vectors3) -> None:
    """Give all axes one scale, with y of the world downwards."""
    least, greatest = np.nanmin(points, axis=0), np.nanmax(points, axis=0)
    middle, half = 0.5 * (least + greatest), 0.55 * float((greatest - least).max())
    axes.set_xlim(middle[0] - half, middle[0] + half)
    axes.set_ylim(middle[2] - half, middle[2] + half)
    axes.set_zlim(middle[1] + half, middle[1] - half)
    axes.set_box_aspect((1.0, 1.0, 1.0))
