"""Findings of wrong labels: of pictures, and of dots, between two cameras."""

from collections.abc import Callable
from dataclasses import dataclass

from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import CheckResult, Finding, NotJudged
from labcal.guide.diagnosis.labelling import Labelling
from labcal.wording import counted, listed

_SHOWN = 4


@dataclass(frozen=True)
class LabelMistake:
    """A kind of wrong labels.

    Attributes
    ----------
    check : CheckName
    views : callable
        Returns the views that it concerns, of the labels of two cameras.
    words : str
        What is wrong, with the fields ``first`` and ``second`` (cameras), ``count`` and ``named`` (views).
    mend : str
        What to do.
    """

    check: CheckName
    views: Callable[[Labelling], tuple[str, ...]]
    words: str
    mend: str


def label_findings(evidence: Evidence, mistake: LabelMistake) -> CheckResult:
    """Return the finding of every two cameras that a kind of wrong labels concerns."""
    if evidence.alone is None:
        return NotJudged(mistake.check, f"Cameras could not be calibrated. {evidence.why_not_alone}".strip())
    if len(evidence.alone.alone) == 1:
        return NotJudged(mistake.check, "One camera has none to compare it with.")
    return tuple(
        _finding(evidence, mistake, one.cameras, views)
        for one in evidence.labels
        if (views := mistake.views(one))
    )


def _finding(
    evidence: Evidence, mistake: LabelMistake, cameras: tuple[str, str], views: tuple[str, ...]
) -> Finding:
    """Return the finding of two cameras."""
    words = mistake.words.format(
        first=cameras[0],
        second=cameras[1],
        count=counted(len(views), "view"),
        named=listed([f"'{view}'" for view in views]),
    )
    return Finding(
        mistake.check,
        cameras,
        views,
        words,
        mistake.mend,
        harm_mm=float("inf"),
        harm_percent=float("inf"),
        pictures=evidence.images(views, cameras)[:_SHOWN],
    )
