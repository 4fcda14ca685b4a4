"""The figure of the study: error, epochs and seconds over the number of neurons, a line for every depth."""

from collections.abc import Callable, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullLocator

from labcal.report.inline_svg import LINE, OURS, QUIET, SECOND, TEXT, Ink, inline_svg, page_style
from labcal.report.study import StudyCell
from labcal.report.study_words import of_each_data
from labcal.wording import clipped

_LEAST = 1e-4
"""Smaller values are drawn here: 0.0001 mm, 0.1 ms."""
_LINES: dict[int, tuple[Ink, str, str]] = {1: (OURS, "-", "o"), 2: (SECOND, "--", "s"), 3: (TEXT, ":", "D")}
"""Colour, line and mark of every depth."""
_Figure = Callable[[StudyCell], tuple[float, float, float]]
"""Median, least and greatest."""
_ROWS: tuple[tuple[str, _Figure], ...] = (
    ("RMS error, mm", lambda cell: (cell.rmse_mm, *cell.rmse_range_mm)),
    ("epochs", lambda cell: (cell.epochs, *cell.epochs_range)),
    ("seconds", lambda cell: (cell.seconds, *cell.seconds_range)),
)


def study_figure(cells: Sequence[StudyCell]) -> str:
    """Return an SVG with a column of panels for every kind of data; bands are the range of the seeds.

    Parameters
    ----------
    cells : sequence of StudyCell
    """
    groups = of_each_data(cells)
    with page_style():
        figure = Figure(figsize=(7.6, 6.6), layout="constrained")
        panels = figure.subplots(len(_ROWS), max(len(groups), 1), sharex=True, sharey="row", squeeze=False)
        for line, (label, of_cell) in enumerate(_ROWS):
            for column, (data, group) in enumerate(groups.items()):
                axes = panels[line, column]
                _draw(axes, group, of_cell)
                if line == 0:
                    axes.set_title(clipped(data, 34).replace("$", r"\$"), fontsize=9)
                if line == len(_ROWS) - 1:
                    axes.set_xlabel("hidden neurons, all layers")
            panels[line, 0].set_ylabel(label)
        handles, labels = panels[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False, fontsize=8)
        words = "Error, epochs and seconds of training over the number of neurons, for one to three layers"
        return inline_svg(figure, "study", words)


def _draw(axes: Axes, group: Sequence[StudyCell], of_cell: _Figure) -> None:
    """Draw one panel."""
    axes.set_xscale("log")
    axes.set_yscale("log")
    for cell in group:
        if not cell.layers:
            value = max(of_cell(cell)[0], _LEAST)
            axes.axhline(value, color=QUIET.drawn, linewidth=1.2, label="no hidden layer")
    for layers, (ink, line, mark) in _LINES.items():
        of_depth = sorted((cell for cell in group if cell.layers == layers), key=lambda cell: cell.neurons)
        if not of_depth:
            continue
        neurons = [cell.neurons for cell in of_depth]
        median, low, high = zip(*([max(v, _LEAST) for v in of_cell(cell)] for cell in of_depth), strict=True)
        axes.fill_between(neurons, low, high, color=ink.drawn, alpha=0.15, linewidth=0)
        label = f"{layers} {'layer' if layers == 1 else 'layers'}"
        axes.plot(
            neurons, median, color=ink.drawn, linestyle=line, marker=mark, markersize=4, linewidth=1.4,
            label=label,
        )  # fmt: skip
    ticks = sorted({cell.neurons for cell in group if cell.neurons})
    axes.set_xticks(ticks, [str(tick) for tick in ticks])
    axes.xaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.grid(color=LINE.drawn, linewidth=0.6)
    axes.tick_params(length=0, labelsize=8)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
