"""Pictures of a view that were not taken at the same moment."""

from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import CheckResult
from labcal.guide.diagnosis.forms.explaining import Explanation
from labcal.guide.diagnosis.forms.shoot_model import ShootModel
from labcal.guide.diagnosis.residual_findings import picture_words, residual_findings, view_words


def check(evidence: Evidence) -> CheckResult:
    """Return the finding."""
    return residual_findings(evidence, CheckName.UNSYNCHRONISED, _words)


def _words(model: ShootModel, one: Explanation) -> tuple[str, str]:
    return (
        (
            f"{picture_words(model, one)} saw the target elsewhere than the other one, in "
            f"{view_words(model, one)}: it moved between the exposures, or pictures of different moments "
            "bear the name of one view."
        ),
        (
            "Hold the target still, on a support or with a short exposure, or trigger the cameras together; "
            "take the views again."
        ),
    )
