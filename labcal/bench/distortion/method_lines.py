"""Lines of methods in figures: the look of each, and axes of errors over the oracle's."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullLocator

from labcal.report.inline_svg import GROUND, QUIET, TEXT
from labcal.report.page_axes import plain_axes

_COLOURS = ("#1f83cc", "#d55e00", "#009e73", "#c4699a", TEXT.drawn)
"""Near four of Okabe and Ito (2008), which readers with any colour vision tell apart, with contrast enough in
both themes of a page; and the page's ink."""
_STYLES = (("-", "o"), ("--", "s"), (":", "^"))
_BAND = 0.18
_INCH_A_NAME = 1.1
"""Of the legend."""
_LADDERS = (
    (3.0, (0.5, 0.7, 0.8, 0.9, 0.95, 1.0, 1.05, 1.1, 1.2, 1.3, 1.5, 1.7, 2.0, 2.5, 3.0)),
    (30.0, (0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0, 20.0, 30.0)),
    (1e3, (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0)),
)
"""Ticks of an axis of ratios by how far it reaches."""
_MOST_TICKS = 9


@dataclass(frozen=True)
class MethodPoint:
    """A mark of a method's line.

    Attributes
    ----------
    x : float
    values : (float, float, float)
        The value, and the ends of its band.
    is_flagged : bool
        labcal flags it `model-misfit`.
    """

    method: str
    x: float
    values: tuple[float, float, float]
    is_flagged: bool


@dataclass(frozen=True)
class MethodLook:
    """Colour, line and mark of a method."""

    colour: str
    line: str
    mark: str


def method_looks(methods: Sequence[str]) -> dict[str, MethodLook]:
    """Return the looks of methods by their names; a method looks the same in every figure of a plan.

    Parameters
    ----------
    methods : sequence of str
        All of a plan, in its order, each as often as it likes.
    """
    looks = {}
    for number, method in enumerate(dict.fromkeys(methods)):
        line, mark = _STYLES[number // len(_COLOURS) % len(_STYLES)]
        looks[method] = MethodLook(_COLOURS[number % len(_COLOURS)], line, mark)
    return looks


def draw_methods(axes: Axes, points: Sequence[MethodPoint], looks: Mapping[str, MethodLook]) -> None:
    """Draw a line for each method with its band, the first one on top; open marks are flagged `model-misfit`.

    Parameters
    ----------
    axes : Axes
    points : sequence of MethodPoint
        Of one panel.
    looks : mapping of str to MethodLook
    """
    for method, look in reversed(list(looks.items())):
        own = sorted((one for one in points if one.method == method), key=lambda one: one.x)
        if not own:
            continue
        x = [one.x for one in own]
        middle, low, high = zip(*(one.values for one in own), strict=True)
        axes.fill_between(x, low, high, color=look.colour, alpha=_BAND, linewidth=0)
        axes.plot(x, middle, look.line, color=look.colour, linewidth=1.3, label=method)
        for flagged, face in ((False, look.colour), (True, GROUND.drawn)):
            marks = [(one.x, one.values[0]) for one in own if one.is_flagged is flagged]
            if marks:
                axes.plot(
                    *zip(*marks, strict=True), linestyle="", marker=look.mark, color=look.colour,
                    markerfacecolor=face, markersize=3.5,
                )  # fmt: skip


def legend_below(figure: Figure) -> None:
    """Add a legend of all methods that are drawn below the panels of a figure, the first one first."""
    found = {
        label: line
        for axes in figure.axes
        for line, label in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    drawn = dict(reversed(found.items()))
    across = max(int(figure.get_figwidth() / _INCH_A_NAME), 1)
    figure.legend(
        drawn.values(), drawn.keys(), loc="outside lower center", ncols=across, fontsize=8, frameon=False
    )


def ratio_axis(axes: Axes) -> None:
    """Make the y axis one of errors over the oracle's: logarithmic, with plain numbers, and a line at 1."""
    axes.axhline(1.0, color=QUIET.drawn, linewidth=0.8, zorder=0)  # so that there is something to scale
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    _plain_ticks(axes.yaxis, low, high)
    axes.set_ylim(low, high)
    plain_axes(axes)


def ratio_axis_across(axes: Axes) -> None:
    """Make the x axis one of ratios: logarithmic, with plain numbers, and a line at 1."""
    axes.axvline(1.0, color=QUIET.drawn, linewidth=0.8, zorder=0)
    axes.set_xscale("log")
    low, high = axes.get_xlim()
    _plain_ticks(axes.xaxis, low, high)
    axes.set_xlim(low, high)
    plain_axes(axes)


def _plain_ticks(axis: Axis, low: float, high: float) -> None:
    axis.set_ticks(_ticks(low, high))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_locator(NullLocator())


def _ticks(low: float, high: float) -> list[float]:
    """Return ticks within limits."""
    for reach, ladder in _LADDERS:
        found = [tick for tick in ladder if low <= tick <= high]
        if high / low <= reach and len(found) <= _MOST_TICKS:
            return found
    return [10.0**power for power in range(-3, 13) if low <= 10.0**power <= high]
