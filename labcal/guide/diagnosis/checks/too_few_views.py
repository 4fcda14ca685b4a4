"""Views that are too few to calibrate from, or that leave a larger error than more would."""

from labcal.calibrate.single_calibration import MIN_VIEWS
from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import CheckResult, Finding
from labcal.guide.diagnosis.support.judged_support import lacking, why_not
from labcal.guide.diagnosis.support.remedies import ENOUGH_VIEWS
from labcal.wording import counted, listed


def check(evidence: Evidence) -> CheckResult:
    """Return the finding."""
    too_few = _next_to_none(evidence)
    if too_few:
        return too_few
    open_ = why_not(evidence, CheckName.TOO_FEW_VIEWS)
    found = evidence.remedies
    if open_ is not None or found is None:
        return open_ or ()
    at_best = "" if found.are_few else " at best, tilted and in all places"
    words = (
        (
            f"The cameras are calibrated from {counted(found.views, 'view')}: the expected 3-D error is "
            f"{found.of_views[0]:.2g} mm{at_best}, and would be {found.enough:.2g} mm from {ENOUGH_VIEWS} "
            "good ones."
        ),
        (
            f"Take at least {ENOUGH_VIEWS} views, with the target tilted to all sides and in all "
            "corners of both pictures."
        ),
    )
    return lacking(evidence, CheckName.TOO_FEW_VIEWS, found.of_views, words, found)


def _next_to_none(evidence: Evidence) -> tuple[Finding, ...]:
    """Return the finding where a camera has fewer views than any calibration takes."""
    dots = evidence.detections.where(evidence.detections.ok & evidence.detections.has_id)
    of = {name: tuple(dict.fromkeys(dots.view[dots.camera == name].tolist())) for name in evidence.cameras}
    few = tuple(name for name, views in of.items() if len(views) < MIN_VIEWS)
    if not few or evidence.nominal_poses:
        return ()
    return (
        Finding(
            CheckName.TOO_FEW_VIEWS,
            few,
            tuple(evidence.detections.views),
            f"Too few views to calibrate from: {listed(few)} measured the target in "
            f"{counted(min(len(of[name]) for name in few), 'view')}, and at least {MIN_VIEWS} are needed.",
            f"Take at least {ENOUGH_VIEWS} views, tilted to all sides, that go into all corners.",
            harm_mm=float("inf"),
            harm_percent=float("inf"),
            pictures=evidence.images(evidence.detections.views[:2]),
        ),
    )
