"""Pictures that bear the name of the other camera."""

from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import CheckResult
from labcal.guide.diagnosis.label_findings import LabelMistake, label_findings

_MISTAKE = LabelMistake(
    CheckName.SWAPPED_CAMERAS,
    lambda labels: labels.exchanged,
    "Pictures of '{first}' and '{second}' are exchanged in {count}, or in all others: {named}.",
    "Exchange the names of these pictures, or state which camera took which: `cameras`.",
)


def check(evidence: Evidence) -> CheckResult:
    """Return the finding of every two cameras that it concerns."""
    return label_findings(evidence, _MISTAKE)
