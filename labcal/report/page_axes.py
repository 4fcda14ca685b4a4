"""Axes in the look of pages."""

from matplotlib.axes import Axes

from labcal.report.inline_svg import LINE


def plain_axes(axes: Axes) -> None:
    """Draw a grid behind the data, and no frame but the two axes."""
    axes.grid(color=LINE.drawn, linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
