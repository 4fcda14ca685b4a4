"""A histogram of errors, with figures that sum them up marked in it."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

_MOST_BINS = 60


def error_figure(errors: np.ndarray, label: str, what: str, marks: Mapping[str, float]) -> Figure:
    """Draw how errors are spread.

    Parameters
    ----------
    errors : ndarray, shape (n,)
        Millimetres.
    label, what : str
        Of the axis of errors, with its unit, and what is counted.
    marks : mapping of str to float
        Places to mark, mm, by name; NaN is left out.
    """
    figure = Figure(figsize=(6.5, 4.0), layout="constrained")
    axes = figure.add_subplot()
    bins = int(np.clip(np.sqrt(len(errors)), 5, _MOST_BINS))
    axes.hist(errors, bins=bins, color="C0", alpha=0.7)
    for number, (name, place) in enumerate(marks.items()):
        if np.isfinite(place):
            axes.axvline(place, color=f"C{number + 1}", linestyle="--", label=f"{name}: {place:.3g} mm")
    axes.set_xlabel(label)
    axes.set_ylabel(f"number of {what}")
    axes.set_title(f"{len(errors)} {what}")
    axes.legend(frameon=False)
    return figure
