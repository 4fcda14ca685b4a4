"""Figure of all families: errors over the strength, from the figures by family alone."""

from collections.abc import Sequence

from matplotlib.figure import Figure

from labcal.bench.distortion.method_lines import (
    MethodPoint,
    draw_methods,
    legend_below,
    method_looks,
    ratio_axis,
)
from labcal.bench.distortion.result import FamilyFigures
from labcal.report.inline_svg import inline_svg, page_style

_ACROSS = 2
_PANEL_INCH = 2.2


def family_figure(figures: Sequence[FamilyFigures], name: str) -> str:
    """Return an SVG with a panel for each family: medians of its cells, and bands up to the greatest.

    Parameters
    ----------
    figures : sequence of FamilyFigures
        Of one region.
    name : str
        Begins every id in the element.
    """
    families = list(dict.fromkeys(one.family for one in figures))
    down = -(-len(families) // _ACROSS)
    looks = method_looks([one.method for one in figures])
    with page_style():
        figure = Figure(figsize=(7.6, _PANEL_INCH * down + 0.6), layout="constrained")
        panels = figure.subplots(down, _ACROSS, squeeze=False, sharex=True, sharey=True).ravel()
        for axes, family in zip(panels, families, strict=False):
            own = [one for one in figures if one.family == family]
            draw_methods(axes, list(map(_point, own)), looks)
            axes.set_title(family, fontsize=9)
        for axes in panels[: len(families)]:
            ratio_axis(axes)
            axes.set_xlabel("strength of the distortion", fontsize=9)
            axes.tick_params(length=0, labelsize=8)
        for axes in panels[len(families) :]:
            axes.set_axis_off()
        figure.supylabel("error over the oracle's", fontsize=9)
        legend_below(figure)
        return inline_svg(figure, name, "Error over the oracle's by strength, for each family and method")


def _point(one: FamilyFigures) -> MethodPoint:
    values = (one.over_oracle, one.over_oracle, one.worst)
    return MethodPoint(one.method, one.strength, values, one.flagged == one.cells)
