"""A still figure of cameras, targets and points in space, drawn as the 3-D view begins."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from labcal.geometry.magnification import round_magnification
from labcal.report.error_colours import ERROR_COLOURS
from labcal.report.inline_svg import GROUND, LINE, OURS, QUIET, SECOND, TEXT, inline_svg, page_style
from labcal.report.space import Direction, Space

_MOST_POINTS = 1200
"""Each is an element of the SVG."""
_BAR_SHARE = 0.2
"""Of the width of all: the longest scale bar."""


def space_figure(space: Space, name: str, description: str) -> str:
    """Return an SVG of a space in parallel projection.

    Parameters
    ----------
    space : Space
    name : str
        Begins every id in it.
    description : str
        For those who cannot see it.
    """
    space = space.thinned(_MOST_POINTS)
    view = _Projection(space.directions[0])
    with page_style():
        figure = Figure(figsize=(7.2, 4.6), layout="constrained")
        axes = figure.add_subplot(aspect="equal")
        outlines = [view.of(line) for line in space.outlines]
        axes.add_collection(LineCollection(outlines, colors=LINE.drawn, linewidths=0.8))
        for number, (camera, lines) in enumerate(space.frusta.items()):
            colour = (OURS.drawn, SECOND.drawn)[number % 2]
            axes.add_collection(
                LineCollection([view.of(line) for line in lines], colors=colour, linewidths=1.3)
            )
            x, y = view.of(space.cameras[camera].centre[None])[0]
            axes.annotate(camera, (x, y), (0, -11), textcoords="offset points", color=TEXT.drawn, ha="center")
        _draw_points(axes, space, view)
        axes.autoscale_view()
        _draw_scale_bar(axes)
        axes.set_axis_off()
        if len(space.vectors):
            _draw_colours(figure, axes, space)
        return inline_svg(figure, name, description)


class _Projection:
    """Parallel projection along a direction."""

    def __init__(self, direction: Direction) -> None:
        away = direction.eye - direction.focus
        right = np.cross(direction.up, away)
        up = np.cross(away, right)
        self._axes = np.stack([right / np.linalg.norm(right), up / np.linalg.norm(up)])

    def of(self, p: np.ndarray) -> np.ndarray:
        """Return points (mm) as x to the right and y up, mm."""
        return np.asarray(p @ self._axes.T)


def _draw_points(axes: Axes, space: Space, view: _Projection) -> None:
    """Draw points and error vectors."""
    at = view.of(space.points)
    if len(space.vectors) == 0:
        axes.plot(*at.T, ".", color=QUIET.drawn, markersize=2.5)
        return
    ends = np.stack([at, view.of(space.tips)], axis=1)
    collection = LineCollection(list(ends), cmap=ERROR_COLOURS, linewidths=0.9)
    collection.set_array(space.error_mm)
    axes.add_collection(collection)
    x, y = at.T
    axes.scatter(x, y, c=space.error_mm, cmap=ERROR_COLOURS, s=4, linewidths=0, zorder=3)


def _draw_scale_bar(axes: Axes) -> None:
    """Draw how long some millimetres are, in the lower left corner."""
    low, high = axes.get_xlim()
    bottom, top = axes.get_ylim()
    long = round_magnification(_BAR_SHARE * (high - low))
    y = bottom - 0.03 * (top - bottom)
    axes.plot([low, low + long], [y, y], color=TEXT.drawn, linewidth=2, solid_capstyle="butt")
    axes.annotate(f"{long:g} mm", (low + 0.5 * long, y), (0, 3), textcoords="offset points", ha="center")


def _draw_colours(figure: Figure, axes: Axes, space: Space) -> None:
    """Explain the colours."""
    bar = figure.colorbar(axes.collections[-1], ax=axes, shrink=0.7, label="error (mm)")
    bar.outline.set_edgecolor(GROUND.drawn)
    bar.ax.set_title(f"x {space.magnification:g}", color=QUIET.drawn, fontsize="small")
