"""A lens that was refocused or zoomed between two views."""

import numpy as np

from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import CheckResult
from labcal.guide.diagnosis.forms.explaining import Explanation
from labcal.guide.diagnosis.forms.shoot_model import ShootModel
from labcal.guide.diagnosis.residual_findings import picture_words, residual_findings


def check(evidence: Evidence) -> CheckResult:
    """Return the finding."""
    return residual_findings(evidence, CheckName.REFOCUSED, _words)


def _words(model: ShootModel, one: Explanation) -> tuple[str, str]:
    first = one.hypothesis.views[0]
    percent, shift = 100.0 * float(one.size[0]), float(np.linalg.norm(one.size[1:3]))
    than = "shorter" if percent < 0.0 else "longer"
    return (
        (
            f"{picture_words(model, one)} was refocused before view '{model.views[first]}': from there on "
            f"its focal length is {abs(percent):.2g}% {than}, its principal point {shift:.2g} px away."
        ),
        (
            "Switch autofocus and image stabilisation off, lock the focus ring, and take the views again, or "
            f"calibrate from the {model.forms.views - first} views after the change if these are enough."
        ),
    )
