"""Messages about cameras of a rig that contradict each other."""

from labcal.calibrate.handheld_calibration import HandheldCalibration


def contradiction_message(found: HandheldCalibration) -> list[str]:
    """Return the message with the likely causes in order; empty if the cameras agree."""
    doubt = found.disagreement
    if doubt is None:
        return []
    contradiction = (
        f"the cameras contradict each other: together they miss the dots by {found.rms_px:.3g} px RMS, each "
        f"alone by {found.rms_alone_px:.3g} px. Do not rely on this rig: points from it are flagged "
        f"'model-misfit'. Views that show it: {', '.join(doubt.views)}. Likely causes:"
    )
    causes = (f"{number}. {one.cause.value}: {one.why}" for number, one in enumerate(doubt.causes, start=1))
    return [contradiction, *causes]
