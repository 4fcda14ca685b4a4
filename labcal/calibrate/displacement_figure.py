"""A figure of the displacements of the dots of a print, as arrows on the grid."""

import numpy as np
from matplotlib.figure import Figure

from labcal.calibrate.freed_dots import FreedDots
from labcal.geometry.magnification import round_magnification

_LENGTH = 0.4
"""Longest arrow, as a share of the pitch."""


def displacement_figure(dots: FreedDots) -> Figure:
    """Draw an arrow for every freed dot, magnified, its colour the height, circles the uncertainty."""
    target, freed = dots.target, dots.freed
    p, d = target.points(), dots.displacement
    longest = max(float(np.linalg.norm(d[freed][:, :2], axis=1).max(initial=0.0)), 1e-12)
    pitch = float(np.linalg.norm(p[1] - p[0]))
    magnified = round_magnification(_LENGTH * pitch / longest)
    width, height = np.ptp(p[:, 0]), np.ptp(p[:, 1])
    figure = Figure(figsize=(9.0, 1.5 + 8.0 * height / width), dpi=120, layout="constrained")
    axes = figure.add_subplot(aspect="equal", xlabel="x [mm]", ylabel="y [mm]")
    axes.plot(*p[freed, :2].T, ".", color="0.6", markersize=4)
    axes.plot(*p[~freed, :2].T, "x", color="0.4", markersize=6)
    arrows = axes.quiver(
        *p[freed, :2].T, *(magnified * d[freed, :2].T), 1e3 * d[freed, 2],
        angles="xy", scale_units="xy", scale=1.0, width=0.003, cmap="coolwarm",
    )  # fmt: skip
    sigma = magnified * np.sqrt(0.5 * (dots.sigma[freed][:, :2] ** 2).sum(axis=1))
    turn = np.linspace(0.0, 2.0 * np.pi, 24)
    tips = p[freed, :2] + magnified * d[freed, :2]
    axes.plot(
        (tips[:, :1] + sigma[:, None] * np.cos(turn)).T, (tips[:, 1:] + sigma[:, None] * np.sin(turn)).T,
        color="0.7", linewidth=0.6, zorder=0,
    )  # fmt: skip
    figure.colorbar(arrows, label="height [µm]", shrink=0.8)
    axes.set_title(f"{target.name}: displacements x {magnified:g}; crosses stay where declared")
    return figure
