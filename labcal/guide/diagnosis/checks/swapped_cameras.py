"""Pictures that bear the name of the other camera."""

from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import CheckResult, Finding, NotJudged
from labcal.wording import counted, listed

_SHOWN = 4


def check(evidence: Evidence) -> CheckResult:
    """Return the finding of every two cameras that it concerns."""
    if evidence.alone is None:
        return NotJudged(
            CheckName.SWAPPED_CAMERAS, f"Cameras could not be calibrated. {evidence.why_not_alone}".strip()
        )
    if len(evidence.alone.alone) == 1:
        return NotJudged(CheckName.SWAPPED_CAMERAS, "One camera has none to compare it with.")
    found = []
    for one in evidence.labels:
        views = one.exchanged
        if not views:
            continue
        first, second = one.cameras
        named = listed([f"'{view}'" for view in views])
        words = (
            f"Pictures of '{first}' and '{second}' are exchanged in {counted(len(views), 'view')}, or in all "
            f"others: {named}."
        )
        mend = "Exchange the names of these pictures, or state which camera took which: `cameras`."
        found.append(
            Finding(
                CheckName.SWAPPED_CAMERAS,
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
