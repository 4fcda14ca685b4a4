"""Warnings of a calibration, in words."""

from labcal.calibrate.agreement.words import contradiction_message
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.calibrate.lens_warnings import lens_warnings
from labcal.calibrate.view_warnings import disagreeing_views
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
    if found.sources.views.is_beyond_chance and found.disagreement is None:
        warnings.append(disagreeing_views(found, lens))
    if found.reason in (StopReason.EPOCHS, StopReason.NOT_FINITE):
        warnings.append(f"the adjustment has not come to its end: {found.reason.value}")
    return warnings


def _middle_inside(camera: CameraRecord) -> bool:
    """Tell whether a camera's principal point lies in its picture."""
    (_, _, cx), (_, _, cy), _ = camera.K
    width, height = camera.size
    return 0.0 <= cx <= width - 1 and 0.0 <= cy <= height - 1
