"""A camera that was moved between two views, and stayed there."""

import numpy as np

from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import CheckResult
from labcal.guide.diagnosis.forms.explaining import Explanation
from labcal.guide.diagnosis.forms.shoot_model import ShootModel
from labcal.guide.diagnosis.residual_findings import picture_words, residual_findings


def check(evidence: Evidence) -> CheckResult:
    """Return the finding."""
    return residual_findings(evidence, CheckName.CAMERA_MOVED, _words)


def _words(model: ShootModel, one: Explanation) -> tuple[str, str]:
    turn, shift = np.degrees(np.linalg.norm(one.size[:3])), np.linalg.norm(one.size[3:6])
    first = one.hypothesis.views[0]
    before, after = first, model.forms.views - first
    return (
        (
            f"{picture_words(model, one)} was moved before view '{model.views[first]}': from there on it is "
            f"turned by {turn:.2g} degrees and shifted by {shift:.2g} mm beside the views before."
        ),
        (
            f"Fasten the cameras. Calibrate from the {after} views after the move if these are enough (the "
            f"{before} before it are of a rig that is no more), or take new ones."
        ),
    )
