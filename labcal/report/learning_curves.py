"""Learning curves of networks: mean squared error over epochs."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from labcal.report.inline_svg import OURS, QUIET, SECOND, TEXT, inline_svg, page_style
from labcal.report.page_axes import plain_axes

_MOST_STEPS = 600
"""Of a curve; more are thinned out evenly on the logarithmic axis."""


def learning_curves(curves: Mapping[str, np.ndarray]) -> str:
    """Return an SVG of curves on logarithmic axes.

    Parameters
    ----------
    curves : mapping of str to ndarray, shape (epochs + 1,)
        Mean squared error of the scaled outputs before the first epoch and after each, by method.
    """
    colours, styles = (OURS.drawn, SECOND.drawn, TEXT.drawn, QUIET.drawn), ("-", "--", "-.", ":")
    with page_style():
        figure = Figure(figsize=(5.6, 3.4), layout="constrained")
        axes = figure.add_subplot()
        for number, (name, errors) in enumerate(curves.items()):
            steps = np.unique(np.geomspace(1, len(errors), _MOST_STEPS).astype(int))
            axes.plot(steps, errors[steps - 1], styles[number % 4], color=colours[number % 4], label=name)
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel("epoch (1 is the start)")
        axes.set_ylabel("mean squared error (scaled)")
        plain_axes(axes)
        axes.legend(frameon=False)
        return inline_svg(figure, "learning", "Learning curves: mean squared error over epochs")
