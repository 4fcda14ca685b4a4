"""Targets that are numbered from the other corner in one camera."""

from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import CheckResult
from labcal.guide.diagnosis.label_findings import LabelMistake, label_findings

_MISTAKE = LabelMistake(
    CheckName.TURNED_TARGET,
    lambda labels: labels.turned,
    "Cameras '{first}' and '{second}' number the target from opposite corners in {count}: {named}.",
    "Use a target whose numbering is unambiguous (with rings or a code), or number the dots of one camera "
    "from the other corner in these views.",
)


def check(evidence: Evidence) -> CheckResult:
    """Return the finding of every two cameras that it concerns."""
    return label_findings(evidence, _MISTAKE)
