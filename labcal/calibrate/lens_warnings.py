"""Warnings about the lens of a calibrated camera, in words."""

from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.calibrate.one_lens import TwoLenses
from labcal.calibrate.print_warnings import uneven_message
from labcal.cameras.blind_pixels import blind_pixels


def lens_warnings(found: HandheldCalibration, lens: str, name: str) -> list[str]:
    """Return the warnings about one camera's lens.

    Parameters
    ----------
    found : HandheldCalibration
    lens : str
        Name of the lens model.
    name : str
        Of the camera.
    """
    fit = found.fits[name]
    warnings = []
    if fit.open_lens:
        warnings.append(
            f"the dots of {name} leave its lens open towards the picture's border, where only an "
            "assumption holds it: trust the rig where dots were, or take views with dots in the corners"
        )
    if blind := blind_pixels(name, found.rig.camera(name)):
        warnings.append(blind)
    left_open = ", ".join(fit.undetermined)
    if left_open:
        warnings.append(
            f"the views of {name} do not determine {left_open} of the lens '{lens}': trust the rig "
            "where dots were, but not these numbers, or let `lens='auto'` choose"
        )
    if fit.two_lenses is not None:
        return [*warnings, two_lenses_message(name, fit.two_lenses, lens)]
    if fit.misfit is not None:
        warnings.append(
            f"the lens model '{lens}' is too simple for {name}: coefficients of '{fit.misfit.larger}' that "
            f"it does not have are not 0 (p = {fit.misfit.chance:.1g}). Points may be off by more than is "
            "stated. Name a larger lens model, or none"
        )
    if found.freed is None and fit.uneven:
        warnings.append(uneven_message(found, name))
    return warnings


def two_lenses_message(name: str, found: TwoLenses, lens: str) -> str:
    """Return the message about two groups of views of a camera, the most likely cause first."""
    one, other = (", ".join(group) for group in found.groups)
    return (
        f"the views of {name} are not those of one lens: {one} want another one than {other}. Its numbers "
        "are of neither. The likely causes, in order: the pictures of two cameras were taken for one "
        "(distinguish them with `cameras` of 'detect'); the camera was refocused or zoomed in between; the "
        f"lens model '{lens}' does not suit (try `lens='auto'`)"
    )
