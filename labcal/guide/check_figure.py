"""The result of a check as a figure: what changed or could have been found, and the errors of points."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from labcal.guide.rig_check import CheckVerdict, RigCheck

_SLOTS = 4
"""Least number of bars that an axis has room for, so that a single bar does not fill it."""
_ROOM = 1.25
"""Length of the axis over that of the longest bar, for the figure at its end."""


def check_figure(found: RigCheck) -> Figure:
    """Return explanations with their probabilities, or what would have been found; and errors in mm.

    Parameters
    ----------
    found : RigCheck
        Of a changed rig the likeliest explanations are drawn, and how likely it is each camera; of another
        one the smallest changes that would be found nine times in ten are listed.
    """
    figure = Figure(figsize=(8.4, 3.2), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.2, 1.0))
    if found.verdict is CheckVerdict.CHANGED:
        shares = {f"{' or '.join(one.cameras)}: {one.kind.value}": one.probability for one in found.changes}
        shares |= {f"camera {name}": share for name, share in found.by_camera.items()}
        _bars(left, shares, ".2f")
        left.set(xlabel="probability", xlim=(0.0, _ROOM), xticks=(0.0, 0.5, 1.0))
    else:
        _list(left, [one.words for one in found.smallest])
    left.set_title(_title(found))
    cost = None if found.cost is None else found.cost.rms_mm
    errors = {
        "by the change": cost,
        "sigma of a point": found.budget_mm,
        "could be missed": found.undetected_mm,
    }
    known = {name: value for name, value in errors.items() if value is not None and np.isfinite(value)}
    _bars(right, known, ".2g")
    right.set(xlabel="RMS error of points (mm)", xlim=(0.0, _ROOM * max([*known.values(), 1e-9])))
    right.set_title("errors of points")
    return figure


def _title(found: RigCheck) -> str:
    chance = "p < 1e-99" if found.p_value < 1e-99 else f"p = {found.p_value:.2g}"  # noqa: PLR2004 -- shown
    return f"{found.verdict.value} ({chance})"


def _bars(axes: Axes, values: dict[str, float], form: str) -> None:
    """Draw horizontal bars with their values, the first at the top."""
    at = np.arange(len(values))
    bars = axes.barh(at, list(values.values()), height=0.55)
    axes.bar_label(bars, [f"{value:{form}}" for value in values.values()], padding=3.0)
    axes.set_yticks(at, list(values))
    axes.set_ylim(max(_SLOTS, len(values)) - 0.5, -0.5)
    axes.spines[["top", "right"]].set_visible(False)


def _list(axes: Axes, words: list[str]) -> None:
    """Write the smallest changes that would be found, a line each."""
    axes.set_axis_off()
    lines = ["found nine times in ten:", *words]
    for number, line in enumerate(lines):
        axes.text(
            0.0,
            1.0 - (number + 0.5) / max(_SLOTS, len(lines)),
            line,
            transform=axes.transAxes,
            va="center",
            fontsize="small",
            weight="bold" if number == 0 else "normal",
        )
