"""The common part of checks of views: whether they can be made, and a finding of one."""

from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import Finding, NotJudged
from labcal.guide.diagnosis.support.remedies import Remedies, increase

WORTH = 0.15
"""Relative increase of the expected 3-D error from which on a shoot is said to lack something."""
_SHOWN = 4
_PAIR = 2


def why_not(evidence: Evidence, check: CheckName) -> NotJudged | None:
    """Return the reason that the support by views cannot be judged; None where it can."""
    if evidence.nominal_poses:
        return NotJudged(check, "The target stood at known places, so its views need no tilt of their own.")
    if len(evidence.cameras) < _PAIR:
        return NotJudged(check, "3-D errors take two cameras. Give the pictures of both.")
    if evidence.calibration is None:
        return NotJudged(check, f"The cameras could not be calibrated: {evidence.failure}")
    return None


def lacking(
    evidence: Evidence, check: CheckName, errors: tuple[float, float], words: tuple[str, str], found: Remedies
) -> tuple[Finding, ...]:
    """Return a finding where what a shoot lacks is worth it.

    Parameters
    ----------
    evidence : Evidence
    check : CheckName
    errors : (float, float)
        Expected 3-D error without what the shoot lacks and with it, mm, as the words state them.
    words : (str, str)
        What is wrong, and how to mend it.
    found : Remedies
    """
    by = increase(*errors)
    if by < WORTH:
        return ()
    views = () if evidence.calibration is None else tuple(evidence.calibration.views)
    harm = max(0.0, errors[0] ** 2 - errors[1] ** 2) ** 0.5
    return (
        Finding(
            check,
            evidence.cameras,
            views,
            *words,
            harm_mm=harm,
            harm_percent=100.0 * by,
            pictures=evidence.images(views[:_SHOWN], evidence.cameras[:1]),
            explained_by=CheckName.TOO_FEW_VIEWS if _by_few(check, found) else None,
        ),
    )


def _by_few(check: CheckName, found: Remedies) -> bool:
    return check is not CheckName.TOO_FEW_VIEWS and found.are_few and found.by_views >= WORTH
