"""Axes in the look of pages."""

from matplotlib.axes import Axes

from labcal.report.inline_svg import LINE


def plain_axes(axes: Axes) -> None:
    """Draw a grid behind the data, and no frame but the two axes."""
    axes.grid(color=LINE.drawn, linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def picture_axes(axes: Axes, size: tuple[int, int]) -> None:
    """Make axes those of a picture of a size in px: x to the right, y down, no grid over it."""
    width, height = size
    axes.set_xlim(-0.5, width - 0.5)
    axes.set_ylim(height - 0.5, -0.5)
    axes.set_xlabel("x (px)")
    axes.set_ylabel("y (px)")
    plain_axes(axes)
    axes.grid(visible=False)
