"""What it means that the cameras of a rig contradict each other, for people."""

from labcal.calibrate.handheld_calibration import HandheldCalibration


def contradiction_words(found: HandheldCalibration) -> list[str]:
    """Return that they do, and the likely causes in order; nothing where they agree."""
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
