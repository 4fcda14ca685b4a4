"""Warnings of a calibration, in words."""

from labcal.calibrate.agreement.words import contradiction_message
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.calibrate.lens_warnings import lens_warnings
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
        warnings += lens_warnings(found, lens, name)
    views = found.sources.views
    if views.is_beyond_chance and found.disagreement is None:
        warnings.append(
            f"views disagree about the cameras by {views.ratio:.1f} times the squares that the noise of "
            f"their dots explains. Likely causes: the lens model '{lens}' is too simple (try "
            "`lens='auto'`), the board bends or moves, or light and blur move neighbouring dots alike. "
            f"Stated sigmas are wider by this{_sizes(found)}, but hold only what changes from view to view"
        )
    if found.reason in (StopReason.EPOCHS, StopReason.NOT_FINITE):
        warnings.append(f"the adjustment has not come to its end: {found.reason.value}")
    return warnings


def _sizes(found: HandheldCalibration) -> str:
    """Return the sizes of errors that dots of a view share, in parentheses."""
    errors = found.sources.correlated
    if errors is None:
        return ""
    return (
        f" (errors of neighbouring dots of a picture {errors.smooth_px:.2g} px, of the board "
        f"{1000.0 * errors.board_mm:.2g} um, of whole pictures {errors.whole_px:.2g} px)"
    )


def _middle_inside(camera: CameraRecord) -> bool:
    """Tell whether a camera's principal point lies in its picture."""
    (_, _, cx), (_, _, cy), _ = camera.K
    width, height = camera.size
    return 0.0 <= cx <= width - 1 and 0.0 <= cy <= height - 1
