"""Figures of a benchmark of distortion: errors over strength and over points, and coverage."""

import io
from collections.abc import Callable, Iterable, Mapping, Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from labcal.bench.distortion.case import Layout, Measured
from labcal.bench.distortion.cell_summary import CellSummary
from labcal.bench.distortion.checks import HIGH_COVERAGE, LOW_COVERAGE
from labcal.bench.distortion.method_lines import (
    MethodPoint,
    draw_methods,
    legend_below,
    method_looks,
    ratio_axis,
)
from labcal.report.inline_svg import LINE
from labcal.report.page_axes import plain_axes

_PANEL_INCH, _MOST_ACROSS, _MOST_DOWN = 2.6, 4, 6

_ALL_STRENGTHS = (-0.05, 1.05)
"""Limits of an axis from the pinhole to the strongest distortion, with a margin."""


def figures_of(summaries: Sequence[CellSummary]) -> dict[str, str]:
    """Return SVG texts by name: for every family and layout three within the trained volume, one outside."""
    drawn: dict[str, str] = {}
    for family in dict.fromkeys(one.cell.family for one in summaries):
        layouts: tuple[Layout, ...] = tuple(dict.fromkeys(one.cell.layout for one in summaries))
        for layout in layouts:
            own = [one for one in summaries if (one.cell.family, one.cell.layout) == (family, layout)]
            title, ending = f"{family}, {layout}", f"{family}-{layout}.svg"
            within = with_figures(own, Measured.WITHIN)
            if within:
                drawn[f"error-{ending}"] = svg_text(error_figure(within, title), title)
                drawn[f"learning-{ending}"] = svg_text(learning_figure(within, title), title)
                drawn[f"coverage-{ending}"] = svg_text(coverage_figure(within, title), title)
            outside = with_figures(own, Measured.OUTSIDE)
            if outside:
                title = f"{title}, outside the trained volume"
                drawn[f"outside-{ending}"] = svg_text(error_figure(outside, title), title)
    return drawn


def with_figures(summaries: Sequence[CellSummary], region: Measured) -> list[CellSummary]:
    """Return the summaries of a region; none where no cell of it has a figure."""
    own = [one for one in summaries if one.measured == region]
    return own if any(one.over_oracle > 0.0 for one in own) else []


def error_figure(cells: Sequence[CellSummary], title: str) -> Figure:
    """Return errors over the oracle's by strength; a panel for each number of points and noise."""
    figure, panels = _panels(cells, title, _by_noise)
    looks = method_looks([one.method for one in cells])
    for (points, noise), axes in panels.items():
        own = [one for one in cells if (one.cell.points, one.cell.noise_px) == (points, noise)]
        draw_methods(axes, [_point(one, one.cell.strength, _errors(one)) for one in own], looks)
        axes.set_title(f"{points:g} points, {_noise(own)}")
    _reach_over_strengths(panels.values(), cells)
    return _finished(figure, "strength of the distortion", "error over the oracle's", ratio_axis)


def learning_figure(cells: Sequence[CellSummary], title: str) -> Figure:
    """Return errors over the oracle's by the number of points; a panel for each strength and noise."""
    figure, panels = _panels(cells, title, _strength_by_noise)
    looks = method_looks([one.method for one in cells])
    points = sorted({one.cell.points for one in cells})
    for (strength, noise), axes in panels.items():
        own = [one for one in cells if (one.cell.strength, one.cell.noise_px) == (strength, noise)]
        draw_methods(axes, [_point(one, float(one.cell.points), _errors(one)) for one in own], looks)
        axes.set_title(f"strength {strength:g}, {noise:g} px")
        axes.set_xscale("log")
        axes.set_xlim(0.9 * points[0], 1.1 * points[-1])
        axes.set_xticks(points, [str(one) for one in points])
        axes.xaxis.set_minor_locator(NullLocator())
    return _finished(figure, "training points", "error over the oracle's", ratio_axis)


def coverage_figure(cells: Sequence[CellSummary], title: str) -> Figure:
    """Return the coverage of 95% ellipsoids by strength; open marks are flagged `model-misfit`."""
    figure, panels = _panels(cells, title, _by_noise)
    looks = method_looks([one.method for one in cells])
    for (points, noise), axes in panels.items():
        own = [one for one in cells if (one.cell.points, one.cell.noise_px) == (points, noise)]
        draw_methods(axes, [_point(one, one.cell.strength, (one.coverage95,) * 3) for one in own], looks)
        axes.axhspan(LOW_COVERAGE, HIGH_COVERAGE, color=LINE.drawn, zorder=0)
        axes.set_title(f"{points:g} points, {noise:g} px")
        axes.set_ylim(0.0, 1.03)
    _reach_over_strengths(panels.values(), cells)
    return _finished(figure, "strength of the distortion", "coverage of 95% ellipsoids", plain_axes)


def _reach_over_strengths(panels: Iterable[Axes], cells: Sequence[CellSummary]) -> None:
    """Show all strengths on the x axis where the cells have a single one, which gives the axis no scale."""
    if len({one.cell.strength for one in cells}) == 1:
        for axes in panels:
            axes.set_xlim(*_ALL_STRENGTHS)


def _point(one: CellSummary, x: float, values: tuple[float, float, float]) -> MethodPoint:
    return MethodPoint(one.method, x, values, one.flagged_misfit)


def _errors(one: CellSummary) -> tuple[float, float, float]:
    return one.over_oracle, one.low, one.high


def _noise(cells: Sequence[CellSummary]) -> str:
    """Return the noise of cells that have the same, for people."""
    noise = cells[0].cell.stated_noise_px if cells else float("nan")
    return f"{noise:g} px" if np.isfinite(noise) else "noise of the sensor"


def _by_noise(one: CellSummary) -> tuple[float, float]:
    return float(one.cell.points), one.cell.noise_px


def _strength_by_noise(one: CellSummary) -> tuple[float, float]:
    return one.cell.strength, one.cell.noise_px


def _panels(
    cells: Sequence[CellSummary], title: str, places: Callable[[CellSummary], tuple[float, float]]
) -> tuple[Figure, Mapping[tuple[float, float], Axes]]:
    """Return a figure with panels by two factors: one down, one across."""
    down = sorted({places(one)[0] for one in cells})[:_MOST_DOWN]
    across = sorted({places(one)[1] for one in cells})[:_MOST_ACROSS]
    size = (_PANEL_INCH * max(len(across), 2) + 0.4, 0.85 * _PANEL_INCH * len(down) + 1.0)
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(len(down), len(across), squeeze=False, sharex=True, sharey=True)
    figure.suptitle(title, fontsize=9)
    return figure, {(a, b): axes[i, j] for i, a in enumerate(down) for j, b in enumerate(across)}


def _finished(figure: Figure, xlabel: str, ylabel: str, finish: Callable[[Axes], None]) -> Figure:
    """Return a figure with its axes finished, when all is drawn that they share, and its legend."""
    figure.supylabel(ylabel, fontsize=8.5)
    for axes in figure.axes:
        finish(axes)
        axes.title.set_fontsize(8.5)
        axes.tick_params(length=0, labelsize=8)
        axes.set_xlabel(xlabel, fontsize=8.5)
        axes.label_outer()
    legend_below(figure)
    return figure


def svg_text(figure: Figure, name: str) -> str:
    """Return a figure as SVG; the same figure gives the same text."""
    text = io.StringIO()
    with mpl.rc_context({"svg.hashsalt": name, "svg.fonttype": "none"}):
        figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()
