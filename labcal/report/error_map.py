"""Errors over the volume, seen from the front, from above and from the side."""

import numpy as np
from jaxtyping import Float64
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from labcal.arrays import Vectors3
from labcal.report.error_colours import ERROR_COLOURS
from labcal.report.inline_svg import GROUND, inline_svg, page_style
from labcal.report.page_axes import plain_axes

_CELLS = 16
"""Along each side of a panel."""
_PANELS = (("X", "Y"), ("X", "Z"), ("Z", "Y"))
_HIGHEST = 98.0
"""Percentile of the cells' errors at which the colours end."""


def error_map(points: Vectors3, error_mm: Float64[np.ndarray, " n"], name: str = "error-map") -> str:
    """Return an SVG of the RMS error of the points in each cell, in three projections.

    Parameters
    ----------
    points : ndarray, shape (n, 3)
        Mm.
    error_mm : ndarray, shape (n,)
        Length of the error of each.
    name : str
        Begins every id in the element.
    """
    maps = [_cells(points[:, ["XYZ".index(name) for name in panel]], error_mm) for panel in _PANELS]
    known = np.concatenate([rms[np.isfinite(rms)] for rms, _, _ in maps])
    most = float(np.percentile(known, _HIGHEST)) if len(known) else 1.0
    scale = Normalize(0.0, most or 1.0)
    with page_style():
        figure = Figure(figsize=(9.4, 3.4), layout="constrained")
        panels = figure.subplots(1, len(_PANELS))
        for axes, (across, up), (rms, x, y) in zip(panels, _PANELS, maps, strict=True):
            axes.pcolormesh(x, y, rms.T, cmap=ERROR_COLOURS, norm=scale, linewidth=0.2, edgecolor="face")
            axes.set_xlabel(f"{across} (mm)")
            axes.set_ylabel(f"{up} (mm)")
            plain_axes(axes)
        shades = ScalarMappable(scale, ERROR_COLOURS)
        bar = figure.colorbar(shades, ax=panels, label="RMS error (mm)", extend="max", aspect=30)
        bar.outline.set_edgecolor(GROUND.drawn)
        return inline_svg(figure, name, "RMS error of the points over the volume in three projections")


def _cells(at: Float64[np.ndarray, "n 2"], error_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the RMS error by cell, NaN where there is no point, and the edges of the cells."""
    across, up = at.T
    square, x, y = np.histogram2d(across, up, bins=_CELLS, weights=error_mm**2)
    count, _, _ = np.histogram2d(across, up, bins=[x, y])
    mean = np.divide(square, count, out=np.full_like(square, np.nan), where=count > 0)
    return np.sqrt(mean), x, y
