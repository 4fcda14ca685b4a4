"""The result of a check as a figure: how likely each change is, and what would have been found."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from labcal.guide.rig_check import CheckVerdict, RigCheck


def check_figure(found: RigCheck) -> Figure:
    """Return the probabilities of the cameras and of the kinds of changes, given that there is one.

    Parameters
    ----------
    found : RigCheck
    """
    figure = Figure(figsize=(7.2, 3.0), layout="constrained")
    by_kind, by_camera = figure.subplots(1, 2, sharex=True)
    kinds = [f"{' or '.join(one.cameras)}: {one.kind.value}" for one in found.changes]
    _bars(by_kind, kinds, [one.probability for one in found.changes])
    _bars(by_camera, list(found.by_camera), list(found.by_camera.values()))
    by_kind.set_title(f"{found.verdict.value} (p = {found.p_value:.2g})")
    cost = "" if found.cost is None else f"points off by {found.cost.rms_mm:.2g} mm"
    changed = found.verdict is CheckVerdict.CHANGED
    by_camera.set_title(cost if changed else "if there were a change")
    return figure


def _bars(axes: Axes, names: list[str], shares: list[float]) -> None:
    """Draw horizontal bars, the first at the top."""
    at = np.arange(len(names))
    axes.barh(at, shares)
    axes.set_yticks(at, names)
    axes.invert_yaxis()
    axes.set(xlabel="probability", xlim=(0.0, 1.0))
