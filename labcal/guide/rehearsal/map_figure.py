"""The map of expected errors: slices of the working volume as heat maps."""

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, Normalize
from matplotlib.figure import Figure

from labcal.guide.rehearsal.forecast import Forecast
from labcal.guide.rehearsal.planned_rig import CELLS

SLICES = (0, CELLS[2] // 2, CELLS[2] - 1)
"""Near end, middle and far end."""


def map_figure(made: Forecast, colours: str | Colormap = "viridis") -> Figure:
    """Draw the expected error of points in three slices across the volume, and its share by the calibration.

    Parameters
    ----------
    made : Forecast
    colours : str or Colormap
        From small to large.
    """
    rows = {
        "3-D error": made.point_mm,
        "in depth": made.depth_mm,
        "by calibration": made.calibration_point_mm,
        "of shape": made.shape_point_mm,
    }
    shape = CELLS[::-1]
    x, y, z = (np.unique(part) for part in made.grid.T)
    highest = float(np.nanmax(made.point_mm))
    scale = Normalize(0.0, highest)
    figure = Figure(figsize=(9.4, 8.4), layout="constrained")
    panels = figure.subplots(len(rows), len(SLICES), sharex=True, sharey=True)
    for line, (name, values) in zip(panels, rows.items(), strict=True):
        for axes, number in zip(line, SLICES, strict=True):
            axes.pcolormesh(
                x, y, values.reshape(shape)[number], cmap=colours, norm=scale, shading="nearest",
                linewidth=0.2, edgecolor="face",
            )  # fmt: skip
            axes.set_aspect("equal")
        line[0].set_ylabel(f"{name}\nY (mm)")
    for axes, number in zip(panels[0], SLICES, strict=True):
        axes.set_title(f"Z = {z[number]:.0f} mm")
    panels[0][0].invert_yaxis()  # y points down
    for axes in panels[-1]:
        axes.set_xlabel("X (mm)")
    bar = figure.colorbar(ScalarMappable(scale, colours), ax=panels, label="expected error (mm)", aspect=30)
    bar.outline.set_visible(False)
    return figure
