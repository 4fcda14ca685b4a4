"""Misfit of every view of a shoot, and the views that findings concern."""

import numpy as np
from jaxtyping import Float64
from matplotlib.figure import Figure

from labcal.report.inline_svg import OURS, QUIET, SECOND, inline_svg, page_style
from labcal.report.page_axes import plain_axes
from labcal.wording import clipped

_MOST_NAMES = 30
"""Views that are named below the axis."""


def view_misfits(
    views: tuple[str, ...], misfit: Float64[np.ndarray, " views"], concerned: frozenset[str], name: str
) -> str:
    """Return an SVG of the residuals of each view, in units of their expected size.

    Parameters
    ----------
    views : tuple of str
    misfit : ndarray, shape (views,)
        RMS residual over the expected one, where all views share one rig.
    concerned : frozenset of str
        Views of the finding, which are marked.
    name : str
        Id of the figure.
    """
    at = np.arange(len(views))
    marked = np.array([view in concerned for view in views])
    with page_style():
        figure = Figure(figsize=(6.4, 2.6), layout="constrained")
        axes = figure.add_subplot()
        axes.plot(at[~marked], misfit[~marked], "o", color=OURS.drawn, label="other views")
        axes.plot(at[marked], misfit[marked], "X", color=SECOND.drawn, label="views of the finding")
        axes.axhline(1.0, color=QUIET.drawn, linestyle="--", linewidth=1, label="as expected")
        axes.set_ylim(0.0, 1.1 * max(1.0, float(misfit.max(initial=1.0))))
        axes.set_ylabel("residual / expected")
        if len(views) <= _MOST_NAMES:
            axes.set_xticks(at, [clipped(view, 16) for view in views], rotation=45, ha="right")
        else:
            axes.set_xlabel("view")
        plain_axes(axes)
        axes.legend(frameon=False, ncols=3, loc="lower left", bbox_to_anchor=(0.0, 1.0), fontsize="small")
        return inline_svg(figure, name, "Residuals of every view, in units of their expected size")
