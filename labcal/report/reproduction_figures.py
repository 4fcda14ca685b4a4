"""The two figures of the page: errors and epochs, the paper's and ours, row by row."""

from collections.abc import Sequence

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from labcal.report.inline_svg import GROUND, LINE, OURS, QUIET, SECOND, TEXT, inline_svg, page_style
from labcal.report.reproduction import RowResult
from labcal.report.row_verdict import EPOCH_FACTOR
from labcal.wording import clipped

PRINTED_LIMIT_MM = 0.005
"""Half of the last digit that the paper prints: what it prints as zero lies below."""
_FLOOR_MM = 1e-4
"""Smaller errors are drawn at the edge; a tenth of a micrometre matters to nobody here."""
_INCH_A_ROW = 0.27
_WIDTH = 5.6
_LEFT, _RIGHT, _ABOVE, _BELOW = 0.55, 0.15, 0.62, 0.45  # inches around the rows


def error_figure(rows: Sequence[RowResult]) -> str:
    """Return an SVG of every row's mean signed error, the paper's and ours, and of our RMS error."""
    with page_style():
        figure, axes = _canvas(rows)
        for place, row in enumerate(rows):
            low, high = _magnitudes(row)
            axes.plot([low, high], [place, place], color=OURS.drawn, linewidth=4, alpha=0.35, zorder=2)
            printed = 1e3 * abs(row.paper_abs_m)
            marker = "s" if printed else "<"
            face = GROUND.drawn if row.contradiction else QUIET.drawn
            _dot(axes, max(printed, PRINTED_LIMIT_MM), place, marker, (face, QUIET.drawn))
            _dot(axes, max(1e3 * abs(row.mean_signed_m), _FLOOR_MM), place, "o", (OURS.drawn, OURS.drawn))
            _dot(axes, max(row.rmse_mm, _FLOOR_MM), place, "D", (GROUND.drawn, SECOND.drawn))
        _finish(axes, rows, "error, mm")
        axes.set_xlim(left=_FLOOR_MM / 1.5)
        _legend(
            axes,
            [
                ("s", (QUIET.drawn, QUIET.drawn), "paper, |mean signed|"),
                ("s", (GROUND.drawn, QUIET.drawn), "paper, contradictory"),
                ("<", (QUIET.drawn, QUIET.drawn), "paper prints zero"),
                ("o", (OURS.drawn, OURS.drawn), "ours, |mean signed|, range of the runs"),
                ("D", (GROUND.drawn, SECOND.drawn), "ours, RMS of the 3-D error"),
            ],
        )
        return inline_svg(figure, "errors", "Errors of every row in millimetres, the paper's and ours")


def epoch_figure(rows: Sequence[RowResult]) -> str:
    """Return an SVG of the epochs of every row with a network, the paper's and ours."""
    shown = [row for row in rows if row.epochs is not None and row.paper_epochs is not None]
    with page_style():
        figure, axes = _canvas(shown)
        for place, row in enumerate(shown):
            paper, ours = float(row.paper_epochs or 1), float(max(row.epochs or 1, 1))
            band = [paper / EPOCH_FACTOR, paper * EPOCH_FACTOR]
            axes.plot(band, [place, place], color=LINE.drawn, linewidth=9, solid_capstyle="butt", zorder=1)
            axes.plot([paper, ours], [place, place], color=OURS.drawn, linewidth=1, alpha=0.5, zorder=2)
            _dot(axes, paper, place, "s", (QUIET.drawn, QUIET.drawn))
            marker, face = (">", GROUND.drawn) if row.goal_reached is False else ("o", OURS.drawn)
            _dot(axes, ours, place, marker, (face, OURS.drawn))
        _finish(axes, shown, "epochs")
        _legend(
            axes,
            [
                ("s", (QUIET.drawn, QUIET.drawn), "paper (band: within a factor of 2)"),
                ("o", (OURS.drawn, OURS.drawn), "ours"),
                (">", (GROUND.drawn, OURS.drawn), "ours, goal not reached"),
            ],
        )
        return inline_svg(figure, "epochs", "Epochs of every row with a network, the paper's and ours")


def _canvas(rows: Sequence[RowResult]) -> tuple[Figure, Axes]:
    """Return a figure as high as its rows need, and its axes."""
    height = _ABOVE + _BELOW + _INCH_A_ROW * max(len(rows), 1)
    figure = Figure(figsize=(_WIDTH, height))
    wide, high = 1 - (_LEFT + _RIGHT) / _WIDTH, 1 - (_ABOVE + _BELOW) / height
    axes = figure.add_axes((_LEFT / _WIDTH, _BELOW / height, wide, high))
    return figure, axes


def _dot(axes: Axes, x: float, y: int, marker: str, colours: tuple[str, str]) -> None:
    """Draw a mark of a face and an edge colour."""
    face, edge = colours
    size = 5.0 if marker == "D" else 6.0
    axes.plot(
        [x], [y], linestyle="", marker=marker, markersize=size, markerfacecolor=face, markeredgecolor=edge,
        markeredgewidth=1.3, zorder=4,
    )  # fmt: skip


def _as_it_is(text: str) -> str:
    """Return a text that matplotlib does not take for a formula."""
    return clipped(text).replace("$", r"\$")


def _finish(axes: Axes, rows: Sequence[RowResult], label: str) -> None:
    """Name the rows and draw the grid."""
    axes.set_xscale("log")
    axes.set_yticks(range(len(rows)), [_as_it_is(f"{row.exp} {row.solver}") for row in rows])
    axes.set_ylim(max(len(rows), 1) - 0.4, -0.6)
    axes.set_xlabel(label)
    axes.xaxis.set_minor_locator(mpl.ticker.NullLocator())
    axes.xaxis.set_major_formatter(mpl.ticker.FuncFormatter(lambda value, _: f"{value:g}"))
    axes.grid(axis="x", color=LINE.drawn, linewidth=0.7)
    axes.set_axisbelow(True)
    axes.tick_params(length=0)
    for place in range(1, len(rows)):
        if rows[place].data != rows[place - 1].data:
            axes.axhline(place - 0.5, color=LINE.drawn, linewidth=0.7, zorder=0)
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)


def _legend(axes: Axes, entries: Sequence[tuple[str, tuple[str, str], str]]) -> None:
    """Explain the marks above the axes."""
    handles = [
        mpl.lines.Line2D(
            [], [], linestyle="", marker=marker, markersize=6, markerfacecolor=face, markeredgecolor=edge,
            markeredgewidth=1.3, label=label,
        )
        for marker, (face, edge), label in entries
    ]  # fmt: skip
    legend = axes.legend(
        handles=handles, loc="lower left", bbox_to_anchor=(-0.1, 1.0), ncols=2, frameon=False,
        fontsize=8, handletextpad=0.2, columnspacing=1.2, borderaxespad=0.2,
    )  # fmt: skip
    for text in legend.get_texts():
        text.set_color(TEXT.drawn)


def _magnitudes(row: RowResult) -> tuple[float, float]:
    """Return the least and the greatest magnitude of the mean signed error among the runs, mm."""
    low, high = row.mean_signed_range_m
    least = 0.0 if low <= 0 <= high else min(abs(low), abs(high))
    return max(1e3 * least, _FLOOR_MM), max(1e3 * abs(low), 1e3 * abs(high), _FLOOR_MM)
