"""A board that is not flat."""

import numpy as np

from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import CheckResult
from labcal.guide.diagnosis.forms.explaining import Explanation
from labcal.guide.diagnosis.forms.shoot_model import ShootModel
from labcal.guide.diagnosis.residual_findings import residual_findings


def check(evidence: Evidence) -> CheckResult:
    """Return the finding."""
    return residual_findings(evidence, CheckName.BENT_BOARD, _words)


def _words(_: ShootModel, one: Explanation) -> tuple[str, str]:
    # Heights are a x^2 + b x y + c y^2, mm at the end of the longer side.
    a, b, c = one.size[:3]
    bend = float(np.abs(np.linalg.eigvalsh([[a, 0.5 * b], [0.5 * b, c]])).max())
    return (
        f"The board is bent: its dots are up to {bend:.2g} mm off a plane at the edge.",
        (
            "Glue the print on a flat plate (glass, aluminium composite), or calibrate with the dots freed: "
            "`dot_places='freed'`."
        ),
    )
