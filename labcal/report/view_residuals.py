"""RMS residual of every picture of a calibration."""

import numpy as np
from jaxtyping import Float64
from matplotlib.figure import Figure

from labcal.report.inline_svg import OURS, QUIET, SECOND, inline_svg, page_style
from labcal.report.page_axes import plain_axes
from labcal.wording import clipped

_MOST_NAMES = 30
"""Views that are named below the axis."""


def view_residuals(
    views: tuple[str, ...],
    cameras: tuple[str, ...],
    rms_px: Float64[np.ndarray, "cameras views"],
    whole_px: float,
) -> str:
    """Return an SVG of the RMS of each picture, px, and of the whole as a line; NaN is left out."""
    colours, marks = (OURS.drawn, SECOND.drawn), "os^v"
    with page_style():
        figure = Figure(figsize=(5.6, 3.2), layout="constrained")
        axes = figure.add_subplot()
        for number, (name, of_camera) in enumerate(zip(cameras, rms_px, strict=True)):
            axes.plot(
                np.arange(len(views)), of_camera, marks[number % 4], label=clipped(name, 20),
                color=colours[number % 2], markersize=4.5,
            )  # fmt: skip
        axes.axhline(
            whole_px, color=QUIET.drawn, linestyle="--", linewidth=1, label=f"all: {whole_px:.3g} px"
        )
        axes.set_ylim(bottom=0.0)
        axes.set_ylabel("RMS residual (px)")
        if len(views) <= _MOST_NAMES:
            axes.set_xticks(range(len(views)), [clipped(view, 16) for view in views], rotation=45, ha="right")
        else:
            axes.set_xlabel("view")
        plain_axes(axes)
        axes.legend(frameon=False, ncols=3, loc="lower right", fontsize="small")
        return inline_svg(figure, "views", "RMS residual of every picture")
