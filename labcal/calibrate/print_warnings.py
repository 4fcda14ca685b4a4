"""Warnings about a print: dots that scatter, and places that were measured in the same views."""

from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.calibrate.single_calibration import HandheldSettings
from labcal.wording import counted


def warnings_of_print(found: HandheldCalibration, settings: HandheldSettings) -> tuple[str, ...]:
    """Return the warning about a print that was measured in the views that are calibrated from."""
    same = [] if settings.places is None else [v for v in found.views if v in settings.places.calibrated_on]
    if not same:
        return ()
    warning = (
        f"by their names, {counted(len(same), 'view')} of these also gave the places in `dots`: errors of "
        "the print and of these pictures are then the same ones, and stated sigmas are too small. Take other "
        "views"
    )
    return (warning,)


def uneven_message(found: HandheldCalibration, name: str) -> str:
    """Return the message about dots of a camera that scatter far more than their noise."""
    scatter = f"the dots of {name} scatter by {found.fits[name].scatter_px:.3f} px beyond their own noise"
    if found.measured_print:
        return (
            f"{scatter}, although the print was measured before: it is another copy of the target, it has "
            "changed, or the lens model does not suit"
        )
    return (
        f"{scatter}: an uneven print or another lens; `dot_places='freed'` estimates where each dot is on "
        "the print"
    )
