"""Figures of a benchmark of distortion: errors over strength and over points, and coverage, as SVG."""

import io
from collections.abc import Callable, Mapping, Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from labcal.bench.distortion.case import Layout, Measured
from labcal.bench.distortion.cell_summary import CellSummary
from labcal.bench.distortion.checks import HIGH_COVERAGE, LOW_COVERAGE

_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
"""Of Okabe and Ito (2008), which readers with any colour vision tell apart."""
_STYLES = ("-", "--", ":")
_PANEL_INCH, _MOST_ACROSS, _MOST_DOWN = 2.6, 4, 6
Value = Callable[[CellSummary], float]


def figures_of(summaries: Sequence[CellSummary]) -> dict[str, str]:
    """Return SVG texts by name: three for every family and layout, within the trained volume."""
    within = [one for one in summaries if one.measured == Measured.WITHIN]
    drawn: dict[str, str] = {}
    for family in dict.fromkeys(one.cell.family for one in within):
        layouts: tuple[Layout, ...] = tuple(dict.fromkeys(one.cell.layout for one in within))
        for layout in layouts:
            own = [one for one in within if (one.cell.family, one.cell.layout) == (family, layout)]
            if not any(one.over_oracle > 0.0 for one in own):
                continue
            title = f"{family}, {layout}"
            ending = f"{family}-{layout}.svg"
            drawn[f"error-{ending}"] = svg_text(error_figure(own, title), title)
            drawn[f"learning-{ending}"] = svg_text(learning_figure(own, title), title)
            drawn[f"coverage-{ending}"] = svg_text(coverage_figure(own, title), title)
    return drawn


def error_figure(cells: Sequence[CellSummary], title: str) -> Figure:
    """Return errors over the oracle's by strength; a panel for each number of points and noise."""
    figure, panels = _panels(cells, f"{title}: RMS error over the oracle's, range of the seeds", _by_noise)
    for (points, noise), axes in panels.items():
        own = [one for one in cells if (one.cell.points, one.cell.noise_px) == (points, noise)]
        _lines(axes, own, lambda one: one.cell.strength, _error)
        axes.set_title(f"{points:g} points, {_noise(own)}")
        _ratio_axis(axes)
    return _finished(figure, "strength")


def learning_figure(cells: Sequence[CellSummary], title: str) -> Figure:
    """Return errors over the oracle's by the number of points; a panel for each strength and noise."""
    figure, panels = _panels(cells, f"{title}: RMS error over the oracle's", _strength_by_noise)
    points = sorted({one.cell.points for one in cells})
    for (strength, noise), axes in panels.items():
        own = [one for one in cells if (one.cell.strength, one.cell.noise_px) == (strength, noise)]
        _lines(axes, own, lambda one: float(one.cell.points), _error)
        axes.set_title(f"strength {strength:g}, {noise:g} px")
        axes.set_xscale("log")
        axes.set_xlim(0.9 * points[0], 1.1 * points[-1])
        _ratio_axis(axes)
    return _finished(figure, "training points")


def coverage_figure(cells: Sequence[CellSummary], title: str) -> Figure:
    """Return the coverage of 95% ellipsoids by strength; open marks are flagged `model-misfit`."""
    figure, panels = _panels(cells, f"{title}: coverage of 95% ellipsoids (open: flagged)", _by_noise)
    for (points, noise), axes in panels.items():
        own = [one for one in cells if (one.cell.points, one.cell.noise_px) == (points, noise)]
        _lines(axes, own, lambda one: one.cell.strength, lambda one: (one.coverage95,) * 3)
        axes.axhspan(LOW_COVERAGE, HIGH_COVERAGE, color="0.85", zorder=0)
        axes.set_title(f"{points:g} points, {noise:g} px")
        axes.set_ylim(0.0, 1.03)
    return _finished(figure, "strength")


def _noise(cells: Sequence[CellSummary]) -> str:
    """Return the noise of cells that have the same, for people."""
    noise = cells[0].cell.stated_noise_px if cells else float("nan")
    return f"{noise:g} px" if np.isfinite(noise) else "noise of the sensor"


def _error(one: CellSummary) -> tuple[float, float, float]:
    return one.over_oracle, one.low, one.high


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
    size = (_PANEL_INCH * len(across) + 1.0, 0.85 * _PANEL_INCH * len(down) + 1.0)
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(len(down), len(across), squeeze=False, sharex=True, sharey=True)
    figure.suptitle(title, fontsize=9)
    return figure, {(a, b): axes[i, j] for i, a in enumerate(down) for j, b in enumerate(across)}


def _lines(
    axes: Axes,
    cells: Sequence[CellSummary],
    place: Value,
    figures: Callable[[CellSummary], tuple[float, float, float]],
) -> None:
    """Draw a line for each method, with the range of its seeds."""
    for number, method in enumerate(dict.fromkeys(one.method for one in cells)):
        own = sorted((one for one in cells if one.method == method), key=place)
        x = [place(one) for one in own]
        middle, low, high = zip(*(figures(one) for one in own), strict=True)
        colour = _COLOURS[number % len(_COLOURS)]
        style = _STYLES[number // len(_COLOURS) % len(_STYLES)]
        axes.plot(x, middle, style, color=colour, linewidth=1.3, label=method)
        axes.fill_between(x, low, high, color=colour, alpha=0.2, linewidth=0)
        for one, at in zip(own, middle, strict=True):
            face = "white" if one.flagged_misfit else colour
            axes.plot([place(one)], [at], "o", color=colour, markerfacecolor=face, markersize=3.5)


def _ratio_axis(axes: Axes) -> None:
    axes.axhline(1.0, color="0.5", linewidth=0.8, zorder=0)  # so that there is something to scale
    axes.set_yscale("log")
    axes.grid(visible=True, color="0.92", linewidth=0.6)


def _finished(figure: Figure, xlabel: str) -> Figure:
    figure.supxlabel(xlabel, fontsize=8)
    for axes in figure.axes:
        axes.title.set_fontsize(7.5)
        axes.tick_params(labelsize=7)
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right upper", fontsize=7, frameon=False)
    return figure


def svg_text(figure: Figure, name: str) -> str:
    """Return a figure as SVG; the same figure gives the same text."""
    text = io.StringIO()
    with mpl.rc_context({"svg.hashsalt": name, "svg.fonttype": "none"}):
        figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()
