"""A figure of a calibration: residuals by view, and over each camera's picture."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from labcal.calibrate.handheld_calibration import HandheldCalibration

_MOST_NAMES = 30
"""Views that are named below the axis."""
_ARROW_SHARE = 0.05
"""Of the picture's width: the length of the arrow of a typical residual."""


def calibration_figure(found: HandheldCalibration) -> Figure:
    """Draw the residuals in the rig; see :meth:`~labcal.calibrate.calibration.Calibration.plot`."""
    cameras = list(found.rig.cameras)
    figure = Figure(figsize=(3.6 * max(2, len(cameras)), 6.4), layout="constrained")
    grid = figure.add_gridspec(2, len(cameras))
    _draw_views(figure.add_subplot(grid[0, :]), found)
    for number, name in enumerate(cameras):
        _draw_picture(figure.add_subplot(grid[1, number]), found, name)
    return figure


def _draw_views(axes: Axes, found: HandheldCalibration) -> None:
    """Draw the RMS of every picture, and that of the rig as a line."""
    views = np.arange(len(found.views))
    rms_px = found.residuals.rms_px(len(found.rig.cameras), len(views))
    for name, of_camera in zip(found.rig.cameras, rms_px, strict=True):
        axes.plot(views, of_camera, "o", label=name)
    axes.axhline(found.rms_px, color="0.4", linestyle="--", label=f"whole rig: {found.rms_px:.3g} px")
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("view")
    axes.set_ylabel("RMS residual (px)")
    if len(views) <= _MOST_NAMES:
        axes.set_xticks(views, found.views, rotation=45, ha="right")
    axes.legend(frameon=False)


def _draw_picture(axes: Axes, found: HandheldCalibration, name: str) -> None:
    """Draw the residuals of one camera where its dots are, as arrows; outliers as crosses."""
    of = found.residuals
    mine = of.camera == list(found.rig.cameras).index(name)
    good, bad = mine & ~of.outlier, mine & of.outlier
    width, height = found.rig.cameras[name].size
    typical = float(np.sqrt((of.residual[good] ** 2).sum(axis=1).mean())) if good.any() else 0.0
    scale = typical / (_ARROW_SHARE * width) if typical > 0.0 else 1.0
    axes.quiver(*of.q[good].T, *of.residual[good].T, angles="xy", scale_units="xy", scale=scale, width=0.004)
    axes.plot(*of.q[bad].T, "x", color="C3")
    axes.set_xlim(-0.5, width - 0.5)
    axes.set_ylim(height - 0.5, -0.5)
    axes.set_aspect("equal")
    axes.set_xlabel("x (px)")
    axes.set_ylabel("y (px)")
    outliers = f", {int(bad.sum())} outliers (x)" if bad.any() else ""
    axes.set_title(f"{name}: residuals x {1.0 / scale:.3g}{outliers}", fontsize="medium")
