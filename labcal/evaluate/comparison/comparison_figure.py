"""The difference of two calibrations over the pictures, as a figure."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from labcal.evaluate.comparison.lens_difference import LATTICE
from labcal.evaluate.comparison.rig_comparison import CameraComparison, distance_text


def comparison_figure(cameras: Sequence[CameraComparison]) -> Figure:
    """Return lengths of differences over each picture, px, with the hulls of both calibrations' dots."""
    figure = Figure(figsize=(5.2 * len(cameras), 4.2), layout="constrained")
    for axes, camera in zip(np.atleast_1d(figure.subplots(1, len(cameras))), cameras, strict=True):
        part = camera.main
        u, v = part.q.T.reshape(2, *LATTICE[::-1])
        drawn = axes.pcolormesh(u, v, part.remaining.length.reshape(u.shape), shading="gouraud", vmin=0.0)
        figure.colorbar(drawn, ax=axes, label=f"difference (px), distance {distance_text(part)} mm")
        for lens, style in ((camera.one, "-"), (camera.other, "--")):
            if len(lens.outline):
                axes.plot(*np.vstack([lens.outline, lens.outline[:1]]).T, style, color="white", linewidth=1)
        axes.set(xlabel="x (px)", ylabel="y (px)", title=camera.name, aspect="equal")
        axes.invert_yaxis()
    return figure
