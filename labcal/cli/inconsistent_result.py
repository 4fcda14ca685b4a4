"""What is told where the cameras of a rig do not agree on where the target was."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from labcal.calibrate.handheld_calibration import HandheldCalibration


@dataclass(frozen=True)
class CauseResult:
    """One thing that may have happened."""

    cause: str
    why: str
    cameras: list[str]
    views: list[str]
    """Those that show it; of a moved camera those after the move."""


@dataclass(frozen=True)
class InconsistentResult:
    """The key ``inconsistent`` in JSON documents."""

    rms_in_rig_px: float
    rms_alone_px: float
    """Over all cameras, each calibrated alone."""
    times: float
    """How many times larger the variance between views is than errors explain."""
    causes: list[CauseResult]
    """The likeliest one first."""
    views: list[str]
    """Those that show the likeliest cause."""


def inconsistent_result(found: "HandheldCalibration") -> InconsistentResult | None:
    """Return the part of a JSON document; None where the cameras agree."""
    doubt = found.disagreement
    if doubt is None:
        return None
    causes = [
        CauseResult(one.cause.value, one.why, list(one.cameras), list(one.views)) for one in doubt.causes
    ]
    return InconsistentResult(found.rms_px, found.rms_alone_px, doubt.times, causes, list(doubt.views))
