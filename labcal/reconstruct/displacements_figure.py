"""A figure of displacements over the views."""

import numpy as np
from matplotlib.figure import Figure

from labcal.reconstruct.displacements import Displacements

_MOST_NAMED = 8
"""Points whose lines are named."""
_MOST_DRAWN = 200
"""Points that have lines; of more, every so manieth has one."""
_MOST_LABELS = 12


def displacements_figure(found: Displacements) -> Figure:
    """Draw displacements along X, Y and Z over the views; see :meth:`Displacements.plot`."""
    views, names = found.views, tuple(dict.fromkeys(found.name.tolist()))
    place = {view: number for number, view in enumerate(views, start=1)}
    at = np.array([place[view] for view in found.view.tolist()])
    step = -(-len(names) // _MOST_DRAWN)
    figure = Figure(figsize=(7.5, 7.0), layout="constrained")
    axes = figure.subplots(3, 1, sharex=True)
    for axis, (panel, letter) in enumerate(zip(axes, "XYZ", strict=True)):
        panel.axhline(0.0, color="0.7", linewidth=0.8)
        for name in names[::step]:
            rows = np.flatnonzero(found.name == name)
            named = {"label": name} if len(names) <= _MOST_NAMED else {"color": "0.6"}
            x = np.concatenate([[0], at[rows]])
            y = np.concatenate([[0.0], found.displacement[rows, axis]])
            panel.plot(x, y, ".-", linewidth=0.8, markersize=4.0, **named)
        moved = [place[view] for view in found.motions]
        mean = [motion.displacement_mm[axis] for motion in found.motions.values()]
        sigma = [2.0 * motion.sigma_displacement_mm[axis] for motion in found.motions.values()]
        panel.errorbar(
            moved, mean, sigma, fmt="ks", markersize=5.0, capsize=3.0, label="rigid motion, 2 sigma"
        )
        panel.set_ylabel(f"d{letter} (mm)")
    ticks = np.unique(np.linspace(0, len(views), min(len(views) + 1, _MOST_LABELS)).round().astype(int))
    axes[-1].set_xticks(ticks, [(found.reference_view, *views)[tick] for tick in ticks])
    axes[-1].set_xlabel("view")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside right upper", fontsize="small")
    figure.suptitle(f"Displacements of {len(names)} points since view '{found.reference_view}'")
    return figure
