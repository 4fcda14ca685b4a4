"""Warnings of a calibration, in words."""

from labcal.calibrate.agreement.words import contradiction_message
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.calibrate.one_lens import TwoLenses
from labcal.calibrate.print_warnings import uneven_message
from labcal.cameras.blind_pixels import blind_pixels
from labcal.cameras.record import CameraRecord
from labcal.optim.stopping import StopReason


def calibration_warnings(found: HandheldCalibration, lens: str, target: str) -> list[str]:
    """Return the warnings in words; `lens` and `target` are names."""
    warnings = contradiction_message(found) + [f"left out {reason}" for reason in found.skipped]
    for name, camera in found.rig.cameras.items():
        if not _middle_inside(camera):
            warnings.append(
                f"the principal point of {name} lies outside its picture: the views do not determine it, or "
                f"the dots are not those of '{target}'"
            )
        if found.fits[name].open_lens:
            warnings.append(
                f"the dots of {name} leave its lens open towards the picture's border, where only an "
                "assumption holds it: trust the rig where dots were, or take views with dots in the corners"
            )
        if blind := blind_pixels(name, found.rig.camera(name)):
            warnings.append(blind)
        left_open = ", ".join(found.fits[name].undetermined)
        if left_open:
            warnings.append(
                f"the views of {name} do not determine {left_open} of the lens '{lens}': trust the rig "
                "where dots were, but not these numbers, or let `lens='auto'` choose"
            )
        groups = found.fits[name].two_lenses
        if groups is not None:
            warnings.append(two_lenses_message(name, groups, lens))
        elif found.freed is None and found.fits[name].uneven:
            warnings.append(uneven_message(found, name))
    views = found.sources.views
    if views.is_beyond_chance and found.disagreement is None:
        warnings.append(
            f"views disagree about the cameras by {views.ratio:.1f} times the squares that the noise of "
            f"their dots explains. Likely causes: the lens model '{lens}' is too simple (try "
            "`lens='auto'`), the board bends or moves, or light and blur move neighbouring dots alike. "
            "Stated sigmas are wider by this, but hold only what changes from view to view"
        )
    if found.reason in (StopReason.EPOCHS, StopReason.NOT_FINITE):
        warnings.append(f"the adjustment has not come to its end: {found.reason.value}")
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


def _middle_inside(camera: CameraRecord) -> bool:
    """Tell whether a camera's principal point lies in its picture."""
    (_, _, cx), (_, _, cy), _ = camera.K
    width, height = camera.size
    return 0.0 <= cx <= width - 1 and 0.0 <= cy <= height - 1
