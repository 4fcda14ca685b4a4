"""A target that moved while cameras with a rolling shutter read their rows."""

from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import CheckResult
from labcal.guide.diagnosis.forms.explaining import Explanation
from labcal.guide.diagnosis.forms.shoot_model import ShootModel
from labcal.guide.diagnosis.residual_findings import residual_findings


def check(evidence: Evidence) -> CheckResult:
    """Return the finding."""
    return residual_findings(evidence, CheckName.ROLLING_SHUTTER, _words)


def _words(model: ShootModel, one: Explanation) -> tuple[str, str]:
    camera = one.hypothesis.camera
    who = "all cameras" if camera is None else f"camera '{model.names[camera]}'"
    return (
        (
            f"In pictures of {who} dots are displaced in proportion to their row: the target moved while a "
            "rolling shutter read the picture."
        ),
        (
            "Hold the target still during the exposure, on a support, or use cameras with a global shutter; "
            "take the views again."
        ),
    )
