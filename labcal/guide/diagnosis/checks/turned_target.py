"""Targets that are numbered from the other corner in one camera."""

from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import CheckResult, Finding, NotJudged
from labcal.wording import counted, listed

_SHOWN = 4


def check(evidence: Evidence) -> CheckResult:
    """Return the finding of every two cameras that it concerns."""
    if evidence.alone is None:
        return NotJudged(
            CheckName.TURNED_TARGET, f"Cameras could not be calibrated. {evidence.why_not_alone}".strip()
        )
    if len(evidence.alone.alone) == 1:
        return NotJudged(CheckName.TURNED_TARGET, "One camera has none to compare it with.")
    found = []
    for one in evidence.labels:
        views = one.turned
        if not views:
            continue
        first, second = one.cameras
        named = listed([f"'{view}'" for view in views])
        words = (
            f"Cameras '{first}' and '{second}' number the target from opposite corners in "
            f"{counted(len(views), 'view')}: {named}."
        )
        mend = (
            "Use a target whose numbering is unambiguous (with rings or a code), or number the dots of one "
            "camera from the other corner in these views."
        )
        found.append(
            Finding(
                CheckName.TURNED_TARGET,
                one.cameras,
                views,
                words,
                mend,
                harm_mm=float("inf"),
                harm_percent=float("inf"),
                pictures=evidence.images(views, one.cameras)[:_SHOWN],
            )
        )
    return tuple(found)
