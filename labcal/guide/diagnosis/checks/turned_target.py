"""Targets that are numbered from the other corner in one camera."""

import numpy as np

from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import CheckResult, Finding, NotJudged
from labcal.guide.diagnosis.label_findings import LabelMistake, label_findings
from labcal.guide.diagnosis.stage_turns import turned_on_stage
from labcal.wording import counted, listed

_MISTAKE = LabelMistake(
    CheckName.TURNED_TARGET,
    lambda labels: labels.turned,
    "Cameras '{first}' and '{second}' number the target from opposite corners in {count}: {named}.",
    "Use a target whose numbering is unambiguous (with rings or a code), or number the dots of one camera "
    "from the other corner in these views.",
)


_SHOWN = 4


def check(evidence: Evidence) -> CheckResult:
    """Return the finding of every two cameras that it concerns, and that of a stage."""
    on_stage = _on_stage(evidence)
    between = label_findings(evidence, _MISTAKE)
    if isinstance(between, NotJudged):
        return on_stage or between
    return (*between, *on_stage)


def _on_stage(evidence: Evidence) -> tuple[Finding, ...]:
    """Return the finding where the board lies another way round than the stage's readings say."""
    turned = turned_on_stage(evidence)
    views = tuple(view for view in evidence.detections.views if view in turned)
    if not views:
        return ()
    angle = float(np.median([turned[view] for view in views]))
    words = (
        f"In {counted(len(views), 'view')} the target lies turned by {angle:.0f} degrees beside the other "
        f"views, while the stage's readings do not: {listed([repr(view) for view in views])}."
    )
    mend = "Lay the target on the stage the same way round in all views, and take these views again."
    return (
        Finding(
            CheckName.TURNED_TARGET,
            evidence.cameras,
            views,
            words,
            mend,
            harm_mm=float("inf"),
            harm_percent=float("inf"),
            pictures=evidence.images(views)[:_SHOWN],
        ),
    )
