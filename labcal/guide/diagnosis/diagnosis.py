"""The diagnosis of a shoot."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import Finding, NotJudged
from labcal.public_object import HtmlTable, PublicObject


@dataclass(frozen=True, eq=False, repr=False)
class Diagnosis(PublicObject):
    """Mistakes of a shoot, the most harmful first.

    Attributes
    ----------
    findings : tuple of Finding
        Mistakes, in the order of harm.
    explained : tuple of Finding
        Signs of mistakes that one of the findings explains.
    not_judged : tuple of NotJudged
        Checks that could not be made.
    evidence : Evidence

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> found = pipeline.diagnose(examples.detections(), examples.TARGET)
    >>> len(found.not_judged) < 15
    True
    """

    findings: tuple[Finding, ...]
    explained: tuple[Finding, ...]
    not_judged: tuple[NotJudged, ...]
    evidence: Evidence

    def _summary(self) -> Mapping[str, object]:
        return {
            "findings": [finding.check.value for finding in self.findings],
            "not_judged": len(self.not_judged),
        }

    def _html_tables(self) -> Sequence[HtmlTable]:
        rows = [[one.check.value, one.words, one.mend] for one in self.findings]
        return [HtmlTable(("check", "what is wrong", "how to mend it"), rows)]
