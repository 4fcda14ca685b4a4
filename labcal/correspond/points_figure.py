"""A figure of points in space."""

import numpy as np
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.axes3d import Axes3D

from labcal.correspond.points import Points


def points_figure(points: Points) -> Figure:
    """Draw points coloured by their standard deviations; see :meth:`Points.plot`.

    Z is drawn into the depth and Y downwards, as a camera sees them.
    """
    known = points.where(np.isfinite(points.point).all(axis=1))
    stated = np.isfinite(known.sigma_mm)
    figure = Figure(figsize=(7.0, 5.5), layout="constrained")
    axes: Axes3D = figure.add_subplot(projection="3d")
    if (~stated).any():
        axes.scatter(*known.point[~stated][:, [0, 2, 1]].T, color="0.6", s=8.0, depthshade=False)
    if stated.any():
        drawn = axes.scatter(
            *known.point[stated][:, [0, 2, 1]].T, c=known.sigma_mm[stated], s=8.0, depthshade=False
        )
        figure.colorbar(drawn, ax=axes, shrink=0.7, pad=0.12, label="standard deviation (mm)")
    axes.set_xlabel("X (mm)")
    axes.set_ylabel("Z (mm)")
    axes.set_zlabel("Y (mm)")
    axes.invert_zaxis()
    if len(known):
        axes.set_box_aspect(np.maximum(np.ptp(known.point[:, [0, 2, 1]], axis=0), 1e-9))
    missing = len(points) - len(known)
    views = len(dict.fromkeys(points.view.tolist()))
    lost = f", {missing} without a solution" if missing else ""
    axes.set_title(f"{len(known)} points of {views} views{lost}")
    return figure
