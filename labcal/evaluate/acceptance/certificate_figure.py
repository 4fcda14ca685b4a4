"""Length errors over the lengths, as a figure."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from labcal.evaluate.acceptance.certificate import Certificate

_COVERED = 2.0
"""Standard deviations that the bars show to both sides."""


def certificate_figure(found: Certificate) -> Figure:
    """Return the errors with twice their standard deviation by noise and reference, and the limits."""
    figure = Figure(figsize=(7.0, 3.2), layout="constrained")
    draw_errors(figure.add_subplot(), found, ("C0", "C3"))
    return figure


def draw_errors(axes: Axes, found: Certificate, colours: tuple[str, str]) -> None:
    """Draw the errors, in the first colour, and the limits, in the second."""
    known, nominal = found.is_measured, found.reference.nominal_mm
    sigma = np.hypot(np.nan_to_num(found.measured.noise_sigma_mm), found.reference.sigma_mm)
    axes.axhline(0.0, color="0.6", linewidth=0.8)
    axes.errorbar(
        nominal[known], found.error_mm[known], _COVERED * sigma[known], fmt="o", color=colours[0],
        markersize=3.5, linewidth=0.9, capsize=2,
    )  # fmt: skip
    if found.settings.limit_mm is not None:
        ends = np.array([0.0, 1.05 * float(nominal.max())])
        for sign in (-1.0, 1.0):
            axes.plot(ends, sign * found.settings.limits_mm(ends), color=colours[1], linewidth=1.4)
        axes.set_xlim(*ends)
    axes.set_xlabel("calibrated length (mm)")
    axes.set_ylabel("error (mm)")
