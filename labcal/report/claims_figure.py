"""The figure of a tested claim: ratios with their intervals, and what the claim states of them."""

import math

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from labcal.report.claims import ClaimResult, ComparisonResult
from labcal.report.inline_svg import GROUND, LINE, OURS, QUIET, SECOND, inline_svg, page_style
from labcal.wording import clipped

_WIDTH, _LEFT, _RIGHT = 7.2, 3.3, 0.2
_ABOVE, _BELOW, _INCH_A_ROW = 0.1, 0.5, 0.32
_ROOM = 2.0
"""The axis reaches beyond all ratios by this factor."""


def claim_figure(claim: ClaimResult) -> str:
    """Return an SVG with a line for every comparison.

    The band is the range of ratios that the claim states; the bar is the 95% interval.
    """
    rows = claim.comparisons
    height = _ABOVE + _BELOW + _INCH_A_ROW * len(rows)
    with page_style():
        figure = Figure(figsize=(_WIDTH, height))
        wide, high = 1 - (_LEFT + _RIGHT) / _WIDTH, 1 - (_ABOVE + _BELOW) / height
        axes = figure.add_axes((_LEFT / _WIDTH, _BELOW / height, wide, high))
        axes.set_xscale("log")
        low, high = _range(rows)
        for place, row in enumerate(rows):
            _draw(axes, place, row, (low, high))
        axes.set_xlim(low, high)
        axes.axvline(1.0, color=QUIET.drawn, linewidth=0.8, zorder=1)
        axes.set_yticks(range(len(rows)), [clipped(row.where, 56).replace("$", r"\$") for row in rows])
        axes.tick_params(length=0, labelsize=8)
        axes.set_ylim(len(rows) - 0.5, -0.5)
        axes.set_xlabel("ratio at the same seed")
        axes.xaxis.set_major_locator(LogLocator(numticks=6))
        axes.xaxis.set_minor_locator(NullLocator())
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        for side in ("top", "right", "left"):
            axes.spines[side].set_visible(False)
        words = f"Ratios of claim {claim.claim} with 95% intervals, and the range that the claim states"
        return inline_svg(figure, f"claim-{claim.claim}", words)


def _draw(axes: Axes, place: int, row: ComparisonResult, limits: tuple[float, float]) -> None:
    """Draw one comparison."""
    stated = {
        "at most": (limits[0], row.factor),
        "more than": (row.factor, limits[1]),
    }.get(row.statement, (1 / row.factor, row.factor))
    axes.barh(
        place, stated[1] - stated[0], left=stated[0], height=0.7, color=LINE.drawn, alpha=0.55, zorder=0
    )
    colour = (SECOND if row.supported is False else OURS).drawn
    if all(math.isfinite(end) for end in row.interval):
        axes.plot(row.interval, [place, place], color=colour, linewidth=2.4, zorder=2, solid_capstyle="butt")
    face = GROUND.drawn if row.supported is None else colour
    axes.plot(
        [row.ratio], [place], linestyle="", marker="o", markersize=6, markerfacecolor=face,
        markeredgecolor=colour, zorder=3,
    )  # fmt: skip


def _range(rows: tuple[ComparisonResult, ...]) -> tuple[float, float]:
    """Return the limits of the axis."""
    values = [1.0, *(end for row in rows for end in (row.ratio, row.factor, *row.interval))]
    shown = [value for value in values if math.isfinite(value) and value > 0]
    return min(shown) / _ROOM, max(shown) * _ROOM
