"""Figures of the sensitivity to faults, as SVG: the error with each fault over that without it."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from labcal.bench.distortion.curves import svg_text
from labcal.bench.distortion.method_lines import method_looks, ratio_axis_across
from labcal.bench.distortion.sensitivity import Sensitivity
from labcal.report.inline_svg import GROUND

_INCH_BY_FAULT, _INCH_BESIDES, _WIDTH_INCH = 0.5, 1.3, 5.6
_BAND = 0.7
"""Share of a line's height over which its methods are spread."""


def sensitivity_figures(found: Sequence[Sensitivity]) -> dict[str, str]:
    """Return SVG texts by name: one for each family in which a method has a figure with a fault."""
    drawn = {}
    for family in dict.fromkeys(one.family for one in found):
        own = [one for one in found if one.family == family]
        if any(np.isfinite(one.over_usual) for one in own):
            title = f"{family}: RMS error with a fault over that without it (open: not noticed)"
            drawn[f"sensitivity-{family}.svg"] = svg_text(sensitivity_figure(own, title), title)
    return drawn


def sensitivity_figure(found: Sequence[Sensitivity], title: str) -> Figure:
    """Return a line of marks for each fault, a mark for each method and cell.

    A mark is filled where a seed is refused or more seeds are flagged `model-misfit` than without the fault.
    A method that refuses all seeds has no error, and stands at the right edge as a cross.
    """
    faults = list(dict.fromkeys(one.label for one in found))
    looks = method_looks([one.method for one in found])
    height = _INCH_BY_FAULT * len(faults) + _INCH_BESIDES
    figure = Figure(figsize=(_WIDTH_INCH, height), layout="constrained")
    axes = figure.subplots()
    figure.suptitle(title, fontsize=9)
    for number, (method, look) in enumerate(looks.items()):
        shift = _BAND * (number - 0.5 * (len(looks) - 1)) / len(looks)
        colour, mark = look.colour, look.mark
        axes.plot([], [], mark, color=colour, markersize=4.5, label=method)
        for one in (each for each in found if each.method == method):
            y = faults.index(one.label) + shift
            if np.isfinite(one.over_usual):
                face = colour if one.is_noticed else GROUND.drawn
                axes.plot([one.over_usual], [y], mark, color=colour, markerfacecolor=face, markersize=4.5)
            elif one.refused:
                edge = axes.get_yaxis_transform()
                axes.plot([0.985], [y], "x", color=colour, markersize=4.5, transform=edge)
    axes.set_yticks(range(len(faults)), faults)
    axes.set_ylim(len(faults) - 0.5, -0.5)
    axes.tick_params(labelsize=7)
    ratio_axis_across(axes)
    axes.grid(visible=False, axis="y")
    axes.set_xlabel("error with the fault over that without it (x: refused)", fontsize=8)
    figure.legend(loc="outside lower center", ncols=len(looks), fontsize=8, frameon=False)
    return figure
