"""The checks of a diagnosis by name, each in a module of its own with a function ``check``."""

from collections.abc import Callable
from importlib import import_module

from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import CheckResult, NotJudged

CHECKS: dict[CheckName, str] = {
    CheckName.SWAPPED_CAMERAS: "swapped_cameras",
    CheckName.TURNED_TARGET: "turned_target",
    CheckName.UNSYNCHRONISED: "unsynchronised",
    CheckName.CAMERA_MOVED: "camera_moved",
    CheckName.REFOCUSED: "refocused",
    CheckName.ROLLING_SHUTTER: "rolling_shutter",
    CheckName.BENT_BOARD: "bent_board",
    CheckName.WRONG_PITCH: "wrong_pitch",
    CheckName.WRONG_TARGET: "wrong_target",
    CheckName.BLURRED: "blurred",
    CheckName.EXPOSURE: "exposure",
    CheckName.MIXED_SIZES: "mixed_sizes",
    CheckName.TOO_FEW_VIEWS: "too_few_views",
    CheckName.TOO_LITTLE_TILT: "too_little_tilt",
    CheckName.POOR_COVERAGE: "poor_coverage",
}
"""Modules of the checks below ``labcal.guide.diagnosis.checks``."""


def run_check(name: CheckName, evidence: Evidence) -> CheckResult:
    """Return the result of one check."""
    module = CHECKS.get(name)
    if module is None:
        return NotJudged(name, "This check is not available.")
    check: Callable[[Evidence], CheckResult] = import_module(f"labcal.guide.diagnosis.checks.{module}").check
    return check(evidence)
