"""The warning that views disagree about the cameras, with what dots of a view have in common."""

from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.calibrate.lens_misfit import larger_lenses

_LEAST = 1e-6
"""Px or mm, below which a standard deviation is nothing."""


def disagreeing_views(found: HandheldCalibration, lens: str) -> str:
    """Return the warning, with the causes that the residuals and the test of the lens leave.

    Parameters
    ----------
    found : HandheldCalibration
        Its views disagree beyond chance.
    lens : str
        Name of the lens model.
    """
    ratio = found.sources.views.ratio
    return (
        f"views disagree about the cameras by {ratio:.1f} times the squares that the noise of their dots "
        f"explains. {_shared(found)} {_of_the_lens(found, lens)} Stated sigmas are wider by the "
        "disagreement, but do not hold what is alike in all views"
    )


def _shared(found: HandheldCalibration) -> str:
    """Return the errors that dots of a view have in common, with their causes."""
    errors = found.sources.correlated
    parts = []
    if errors is not None:
        if errors.whole_px > _LEAST:
            parts.append(
                f"shifts of whole pictures of {errors.whole_px:.2g} px (a camera moves, or the target does "
                "between the exposures of a view)"
            )
        if errors.board_mm > _LEAST:
            parts.append(f"{1000.0 * errors.board_mm:.2g} um on the board (it bends)")
        if errors.smooth_px > _LEAST:
            parts.append(f"{errors.smooth_px:.2g} px of neighbouring dots of a picture (by light or blur)")
    if not parts:
        return "Likely causes: the board bends or moves, or light and blur move neighbouring dots alike."
    return f"Dots of a view have errors in common, 1 sigma: {', '.join(parts)}."


def _of_the_lens(found: HandheldCalibration, lens: str) -> str:
    """Return whether the lens model may be a cause, by the test of further coefficients."""
    fits = list(found.fits.items())
    simple = [name for name, fit in fits if fit.misfit is not None]
    if simple:
        return f"The lens model '{lens}', which is too simple for {' and '.join(simple)}, is one cause."
    if all(larger_lenses(found.rig.camera(name)) for name, _ in fits):
        return f"The lens model '{lens}' is hardly the cause: a test of further coefficients finds none."
    return f"The lens model '{lens}' may be another cause, which no test of further coefficients excludes."
