"""Lengths over a camera's picture as colours, with the region where dots supported the calibrations."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from labcal.arrays import Pixels
from labcal.report.error_colours import ERROR_COLOURS
from labcal.report.inline_svg import GROUND, TEXT, inline_svg, page_style
from labcal.report.page_axes import picture_axes

_STYLES = ("solid", "dashed")


def difference_map(
    name: str,
    q: Pixels,
    px: Float64[np.ndarray, " n"],
    size: tuple[int, int],
    outlines: Sequence[Float64[np.ndarray, "_ 2"]],
    most_px: float,
) -> str:
    """Return an SVG of lengths over a picture.

    Parameters
    ----------
    name : str
        Of the map, which begins every id in it.
    q : ndarray, shape (n, 2)
        A lattice, row by row, px.
    px : ndarray, shape (n,)
        NaN where there is nothing.
    size : (int, int)
        Of the picture, px.
    outlines : sequence of ndarray, shape (vertices, 2)
        Hulls of the dots of calibrations; the second one is dashed.
    most_px : float
        Where the colours end, the same for maps that are to be compared.
    """
    width, height = size
    u, v = np.unique(q[:, 0]), np.unique(q[:, 1])
    scale = Normalize(0.0, most_px or 1.0)
    with page_style():
        figure = Figure(figsize=(4.6, 0.9 + 3.6 * height / width), layout="constrained")
        axes = figure.add_subplot(aspect="equal")
        # A picture with a pixel for each place: as many rectangles would be a hundred times as many bytes.
        du, dv = 0.5 * (u[1] - u[0]), 0.5 * (v[1] - v[0])
        axes.imshow(
            px.reshape(len(v), len(u)),
            cmap=ERROR_COLOURS,
            norm=scale,
            interpolation="none",
            extent=(u[0] - du, u[-1] + du, v[-1] + dv, v[0] - dv),
        )
        for outline, style in zip(outlines, _STYLES, strict=False):
            if len(outline):
                axes.plot(*np.vstack([outline, outline[:1]]).T, color=TEXT.drawn, linestyle=style)
        picture_axes(axes, size)
        shades = ScalarMappable(scale, ERROR_COLOURS)
        bar = figure.colorbar(shades, ax=axes, label="px", extend="max", aspect=30)
        bar.outline.set_edgecolor(GROUND.drawn)
        return inline_svg(figure, f"map-{name}", f"Lengths over the picture: {name}")
