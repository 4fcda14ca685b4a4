"""Residual vectors over a camera's picture: where a wrong lens shows."""

import numpy as np
from jaxtyping import Bool, Float64
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from labcal.arrays import Pixels
from labcal.geometry.magnification import round_magnification
from labcal.report.inline_svg import OURS, QUIET, SECOND, TEXT, inline_svg, page_style
from labcal.report.page_axes import picture_axes

CELLS = 10
"""Along the longer side of the picture; a thick arrow is the mean of a cell."""
_FEWEST = 3
"""Dots that a mean is of, at least."""
_MOST_ARROWS = 900
"""Thin arrows: each is an element of the SVG."""
_LONG = 0.05
"""Of the picture's width: an arrow of the 90th percentile."""
_LARGE = 90.0


def residual_magnification(residual: Float64[np.ndarray, "n 2"], width: int) -> float:
    """Return how many times as long residuals (px) are drawn over pictures of a width (px)."""
    length = np.linalg.norm(residual, axis=1)
    length = length[np.isfinite(length)]
    large = max(float(np.percentile(length, _LARGE)) if len(length) else 0.0, 1e-9)
    return round_magnification(_LONG * width / large)


def residual_map(
    name: str,
    q: Pixels,
    residual: Float64[np.ndarray, "n 2"],
    outlier: Bool[np.ndarray, " n"],
    size: tuple[int, int],
    times: float,
) -> str:
    """Return an SVG of residuals where their dots are, with a scale bar in px.

    Parameters
    ----------
    name : str
        Of the camera.
    q : ndarray, shape (n, 2)
        Where the dots are, px.
    residual : ndarray, shape (n, 2)
        Px.
    outlier : ndarray of bool, shape (n,)
        Those are drawn as crosses.
    size : (int, int)
        Width and height of the picture, px.
    times : float
        Residuals are drawn so many times as long; the same for all cameras of a page.
    """
    width, height = size
    good = ~outlier & np.isfinite(residual).all(axis=1)
    with page_style():
        figure = Figure(figsize=(5.6, 0.9 + 5.0 * height / width), layout="constrained")
        axes = figure.add_subplot(aspect="equal")
        kept = np.flatnonzero(good)[:: -(-int(good.sum()) // _MOST_ARROWS) or 1]
        ends = np.stack([q[kept], q[kept] + times * residual[kept]], axis=1)
        axes.add_collection(LineCollection(list(ends), colors=QUIET.drawn, linewidths=0.6))
        _draw_means(axes, q[good], residual[good], size, times)
        axes.plot(*q[outlier].T, "x", color=SECOND.drawn, markersize=5)
        picture_axes(axes, size)
        _draw_scale(axes, times, width)
        return inline_svg(figure, f"residuals-{name}", f"Residual vectors over the picture of camera {name}")


def _draw_means(axes: Axes, q: Pixels, residual: np.ndarray, size: tuple[int, int], times: float) -> None:
    """Draw a thick arrow for the mean of each cell: noise averages out there, a wrong lens does not."""
    cell = max(size) / CELLS
    columns, rows = (max(1, round(side / cell)) for side in size)
    column = np.clip((columns * (q[:, 0] + 0.5) / size[0]).astype(int), 0, columns - 1)
    row = np.clip((rows * (q[:, 1] + 0.5) / size[1]).astype(int), 0, rows - 1)
    number, cells = row * columns + column, rows * columns
    dots = np.bincount(number, minlength=cells)
    full = dots >= _FEWEST
    at, mean = (
        np.stack([np.bincount(number, part, cells)[full] / dots[full] for part in values.T], axis=1)
        for values in (q, residual)
    )
    axes.quiver(
        *at.T, *(times * mean).T, angles="xy", scale_units="xy", scale=1.0, width=0.0055, color=OURS.drawn,
        zorder=3,
    )  # fmt: skip


def _draw_scale(axes: Axes, times: float, width: int) -> None:
    """Draw how long a residual of some px is, above the picture."""
    px = round_magnification(0.15 * width / times)
    high = axes.get_ylim()[0]
    start, y = 0.0, -0.035 * high
    axes.plot(
        [start, times * px], [y, y], color=TEXT.drawn, linewidth=2, clip_on=False, solid_capstyle="butt"
    )
    axes.annotate(
        f"{px:g} px (residuals x {times:g})",
        (times * px, y),
        (6, -3),
        textcoords="offset points",
        annotation_clip=False,
    )
