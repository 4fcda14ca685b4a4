"""Contradictions between the cameras of a rig, as results state them."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # every failure of the command line comes by here
    from labcal.calibrate.agreement.finding import ContradictionError, Disagreement
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

    rms_in_rig_px: float | None
    """None where no rig explains the dots at all."""
    rms_alone_px: float
    """Over all cameras, each calibrated alone."""
    times: float
    """Variance between views over the variance that errors explain."""
    causes: list[CauseResult]
    """The likeliest one first."""
    views: list[str]
    """Those that show the likeliest cause."""


def inconsistent_result(found: "HandheldCalibration") -> InconsistentResult | None:
    """Return the part of a JSON document; None where the cameras agree."""
    doubt = found.disagreement
    return None if doubt is None else _result(doubt, found.rms_px, found.rms_alone_px)


def contradiction_result(error: "ContradictionError") -> InconsistentResult:
    """Return the same where cameras contradict each other so much that there is no rig."""
    return _result(error.disagreement, None, error.rms_alone_px)


def _result(doubt: "Disagreement", in_rig_px: float | None, alone_px: float) -> InconsistentResult:
    causes = [
        CauseResult(one.cause.value, one.why, list(one.cameras), list(one.views)) for one in doubt.causes
    ]
    return InconsistentResult(in_rig_px, alone_px, doubt.times, causes, list(doubt.views))
