"""A histogram of errors, with figures that sum them up."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from labcal.report.inline_svg import OURS, QUIET, SECOND, TEXT, inline_svg, page_style
from labcal.report.page_axes import plain_axes

_MOST_BINS = 50


def error_histogram(errors: np.ndarray, label: str, what: str, marks: Mapping[str, float]) -> str:
    """Return an SVG of a histogram.

    Parameters
    ----------
    errors : ndarray, shape (n,)
        Mm.
    label, what : str
        Of the axis of errors, with its unit, and what is counted.
    marks : mapping of str to float
        Places to mark, mm, by name; NaN is left out.
    """
    colours = (SECOND.drawn, TEXT.drawn, QUIET.drawn)
    with page_style():
        figure = Figure(figsize=(5.6, 3.2), layout="constrained")
        axes = figure.add_subplot()
        bins = int(np.clip(np.sqrt(len(errors)), 5, _MOST_BINS))
        axes.hist(errors, bins=bins, color=OURS.drawn, alpha=0.75)
        for number, (name, place) in enumerate(marks.items()):
            if np.isfinite(place):
                colour = colours[number % len(colours)]
                axes.axvline(
                    place, color=colour, linestyle="--", linewidth=1.3, label=f"{name}: {place:.3g} mm"
                )
        axes.set_xlabel(label)
        axes.set_ylabel(f"number of {what}")
        plain_axes(axes)
        if axes.get_legend_handles_labels()[0]:
            axes.legend(frameon=False, fontsize="small")
        return inline_svg(figure, "histogram", f"Histogram: {label}")
