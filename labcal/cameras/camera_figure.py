"""A figure of a camera: how far its lens displaces the picture of a pinhole."""

import numpy as np
from matplotlib.figure import Figure

from labcal.cameras.camera import Camera

_NODES = 121
_LINES = 13
_SAMPLES = 101
_LEAST_COSINE = 0.17
"""Of the angle off the axis, some 80 degrees: beyond, a pinhole's picture grows out of all bounds."""


def camera_figure(camera: Camera) -> Figure:
    """Draw a camera's distortion over its picture; see :meth:`~labcal.cameras.camera.Camera.plot`.

    Colour is the distance between where a direction is imaged and where a pinhole with the same matrix would
    image it, px. White lines are what a pinhole would image as straight horizontal and vertical ones.
    """
    width, height = camera.size
    u, v = np.linspace(-0.5, width - 0.5, _NODES), np.linspace(-0.5, height - 0.5, _NODES)
    q = np.stack(np.meshgrid(u, v), axis=-1)
    displacement = np.linalg.norm(q - _by_pinhole(camera, q), axis=-1)
    figure = Figure(figsize=(7.0, 0.8 + 6.0 * height / width), layout="constrained")
    axes = figure.add_subplot()
    image = axes.pcolormesh(u, v, np.ma.masked_invalid(displacement), shading="nearest", rasterized=True)
    figure.colorbar(image, ax=axes, label="displacement by the lens (px)")
    for line in _straight_lines(camera):
        axes.plot(*line.T, color="white", linewidth=0.8)
    axes.plot([camera.K[0, 2]], [camera.K[1, 2]], "+", color="white", markersize=12)
    axes.set_xlim(-0.5, width - 0.5)
    axes.set_ylim(height - 0.5, -0.5)
    axes.set_aspect("equal")
    axes.set_xlabel("u (px)")
    axes.set_ylabel("v (px)")
    axes.set_title(f"Distortion of the lens {camera.lens}; + is the principal point")
    return figure


def _by_pinhole(camera: Camera, q: np.ndarray) -> np.ndarray:
    """Return where a pinhole with the camera's matrix images what pixels see; NaN far off the axis."""
    x, y, z = np.moveaxis(camera.rays(q).direction @ camera.T_cam_world[:3, :3].T, -1, 0)
    z = np.where(z > _LEAST_COSINE, z, np.nan)
    fx, fy, cx, cy = camera.intrinsics
    return np.stack([fx * x / z + cx, fy * y / z + cy], axis=-1)


def _straight_lines(camera: Camera) -> list[np.ndarray]:
    """Return the images of lines that a pinhole images as a grid of straight ones, each (n, 2), px."""
    width, height = camera.size
    border = np.concatenate([
        [[u, v] for u in np.linspace(-0.5, width - 0.5, _LINES) for v in (-0.5, height - 0.5)],
        [[u, v] for v in np.linspace(-0.5, height - 0.5, _LINES) for u in (-0.5, width - 0.5)],
    ])  # fmt: skip
    ideal = _by_pinhole(camera, border)
    low, high = np.nanmin(ideal, axis=0), np.nanmax(ideal, axis=0)
    lines = []
    for fixed, free in ((0, 1), (1, 0)):
        for place in np.linspace(low[fixed], high[fixed], _LINES):
            q = np.empty((_SAMPLES, 2))
            q[:, fixed] = place
            q[:, free] = np.linspace(low[free], high[free], _SAMPLES)
            fx, fy, cx, cy = camera.intrinsics
            p_cam = np.column_stack([(q - [cx, cy]) / [fx, fy], np.ones(len(q))])
            lines.append(camera.project_in_camera(p_cam).q)
    return lines
