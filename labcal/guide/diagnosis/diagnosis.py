"""The diagnosis of a shoot."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from labcal.calibrate.agreement.words import contradiction_message
from labcal.calibrate.calibration_warnings import calibration_warnings
from labcal.calibrate.view_warnings import disagreeing_views
from labcal.correspond.measure import Measurement
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

    @property
    def is_usable(self) -> bool:
        """True if a picture shows the target, or another one that is found; if not, nothing can be done."""
        return self.evidence.is_usable or self.evidence.shown_instead is not None

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of a calibration from these pictures that speak of no mistake: of lenses and its end."""
        made = self.evidence.calibration
        if made is None or any(one.harm_percent == float("inf") for one in self.findings):
            return ()
        of_views = {*contradiction_message(made), disagreeing_views(made, self.evidence.lens)}
        warned = calibration_warnings(made, self.evidence.lens, self.evidence.target.name)
        found = bool(self.findings)
        of_refused = {f"left out {reason}" for reason in made.skipped}
        return tuple(one for one in warned if one not in of_refused and not (found and one in of_views))

    @property
    def refused(self) -> tuple[Measurement, ...]:
        """Pictures in which no dot has an id, each with its reason."""
        return tuple(one for one in self.evidence.measurements if not one.indexed)

    def _summary(self) -> Mapping[str, object]:
        return {
            "findings": [finding.check.value for finding in self.findings],
            "not_judged": len(self.not_judged),
        }

    def _html_tables(self) -> Sequence[HtmlTable]:
        rows = [[one.check.value, one.words, one.mend] for one in self.findings]
        return [HtmlTable(("check", "what is wrong", "how to mend it"), rows)]
