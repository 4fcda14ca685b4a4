"""Run all checks on a shoot, and put what they find in the order of harm."""

import numpy as np

from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.diagnosis import Diagnosis
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import Finding, NotJudged
from labcal.guide.diagnosis.registry import run_check


def diagnosed(evidence: Evidence) -> Diagnosis:
    """Return the diagnosis of a shoot.

    Parameters
    ----------
    evidence : Evidence
    """
    found: list[Finding] = []
    open_: list[NotJudged] = []
    for name in CheckName:
        result = run_check(name, evidence)
        if isinstance(result, NotJudged):
            open_.append(result)
        else:
            found += result
    found.sort(key=_harm, reverse=True)
    return Diagnosis(
        findings=tuple(one for one in found if one.explained_by is None),
        explained=tuple(one for one in found if one.explained_by is not None),
        not_judged=tuple(open_),
        evidence=evidence,
    )


def _harm(finding: Finding) -> float:
    """Return the harm to sort by; where it is not known, last but listed."""
    return -np.inf if finding.harm_percent is None else finding.harm_percent
