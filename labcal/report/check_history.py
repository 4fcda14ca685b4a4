"""Checks of a rig over time: the cost of changes beside the budget, and temperature."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from labcal.guide.check_log import CheckRecord
from labcal.guide.rig_check import CheckVerdict
from labcal.report.inline_svg import OURS, QUIET, SECOND, inline_svg, page_style
from labcal.report.page_axes import plain_axes


def check_history(records: Sequence[CheckRecord]) -> str:
    """Return an SVG of the checks in their order.

    Parameters
    ----------
    records : sequence of CheckRecord
        At least one.
    """
    at = np.arange(1, len(records) + 1)
    cost = np.array([_or_nan(one.cost_rms_mm) for one in records])
    budget = np.array([_or_nan(one.budget_mm) for one in records])
    valid = np.array([one.verdict is not CheckVerdict.CHANGED for one in records])
    warmth = np.array([_or_nan(one.temperature_c) for one in records])
    warm = bool(np.isfinite(warmth).any())
    with page_style():
        figure = Figure(figsize=(7.2, 3.6 if warm else 2.6), layout="constrained")
        rows = figure.subplots(2 if warm else 1, 1, sharex=True, squeeze=False)[:, 0]
        rows[0].plot(at, budget, "-", color=QUIET.drawn, label="sigma of a point")
        rows[0].plot(at[valid], budget[valid], "o", color=OURS.drawn, label="no change found")
        rows[0].plot(at[~valid], cost[~valid], "X", color=SECOND.drawn, label="changed: RMS error of points")
        if (np.concatenate([cost, budget]) > 0.0).any():
            rows[0].set_yscale("log")
        rows[0].set_ylabel("mm")
        rows[0].legend(frameon=False, ncols=3, loc="lower left", bbox_to_anchor=(0.0, 1.0))
        if warm:
            rows[1].plot(at, warmth, ".-", color=QUIET.drawn)
            rows[1].set_ylabel("°C")
        rows[-1].set_xlabel("check")
        few = 12
        shown = at if len(at) <= few else at[:: -(-len(at) // few)]
        rows[-1].set_xticks(shown, [records[number - 1].date[:10] for number in shown])
        rows[-1].tick_params(axis="x", rotation=30)
        for axes in rows:
            plain_axes(axes)
        return inline_svg(figure, "history", "Cost of changes and budget of points, check by check")


def _or_nan(value: float | None) -> float:
    return float("nan") if value is None else value
