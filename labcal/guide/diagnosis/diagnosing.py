"""Run all checks on a shoot, and put what they find in the order of harm."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from labcal.calibrate.single_calibration import MIN_VIEWS
from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.diagnosis import Diagnosis
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import Finding, NotJudged
from labcal.guide.diagnosis.registry import run_check

_OF_PICTURES = {CheckName.WRONG_TARGET, CheckName.EXPOSURE, CheckName.BLURRED}
"""Faults by which pictures are refused."""


def diagnosed(evidence: Evidence, checks: Iterable[CheckName] = CheckName) -> Diagnosis:
    """Return the diagnosis of a shoot.

    Parameters
    ----------
    evidence : Evidence
    checks : iterable of CheckName
        Those to make.
    """
    found: list[Finding] = []
    open_: list[NotJudged] = []
    for name in checks:
        result = run_check(name, evidence)
        if isinstance(result, NotJudged):
            open_.append(result)
        else:
            found += result
    found = _of_refused_pictures(found, evidence)
    found.sort(key=_harm, reverse=True)
    return Diagnosis(
        findings=tuple(one for one in found if one.explained_by is None),
        explained=tuple(one for one in found if one.explained_by is not None),
        not_judged=tuple(open_),
        evidence=evidence,
    )


def _of_refused_pictures(found: list[Finding], evidence: Evidence) -> list[Finding]:
    """Return the findings, where too few views are what faults of enough pictures have left."""
    taken = {one.source.view for one in evidence.measurements}
    cause = next(
        (one.check for one in found if one.check in _OF_PICTURES and one.harm_percent == np.inf), None
    )
    if cause is None or len(taken) < MIN_VIEWS:
        return found
    return [
        replace(one, explained_by=cause) if one.check is CheckName.TOO_FEW_VIEWS else one for one in found
    ]


def _harm(finding: Finding) -> float:
    """Return the harm to sort by; where it is not known, last but listed."""
    return -np.inf if finding.harm_percent is None else finding.harm_percent
