"""Views that leave a part of the pictures without dots, where the lens then stays unknown."""

from labcal.correspond.coverage import coverage
from labcal.errors import InputError
from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import CheckResult
from labcal.guide.diagnosis.support.judged_support import lacking, why_not
from labcal.wording import listed


def check(evidence: Evidence) -> CheckResult:
    """Return the finding."""
    open_ = why_not(evidence, CheckName.POOR_COVERAGE)
    found = evidence.remedies
    if open_ is not None or found is None:
        return open_ or ()
    now, spread = found.of_places
    of = "" if now == found.now else " of tilted views"
    words = (
        (
            f"The target does not go over the whole picture: {listed(_shares(evidence))}. Where no dot was, "
            f"the lens is not known: over all that the cameras see the 3-D error to expect{of} is {now:.2g} "
            f"mm, and with views in all places {spread:.2g} mm."
        ),
        (
            "Take views with the target in every corner and at every edge of both pictures; or measure only "
            "where the target has been."
        ),
    )
    return lacking(evidence, CheckName.POOR_COVERAGE, found.of_places, words, found)


def _shares(evidence: Evidence) -> list[str]:
    """Return the covered part of the pictures of every camera, in words."""
    words = []
    for name in evidence.cameras:
        try:
            size = evidence.detections.picture_size(name)
        except InputError:
            continue
        share = float((coverage(evidence.detections, name, size) > 0).mean())
        words.append(f"{name} has dots in {share:.0%} of its picture")
    return words
