"""The answer to "should I use a network?", above the sections of the page."""

from labcal.bench.distortion.network_answer import MARGIN
from labcal.bench.distortion.page.findings import Findings
from labcal.report.page.part import Part
from labcal.report.page.prose import Prose, Tone
from labcal.report.page.written import Written

_NONE = "The plan has no network and another method in the same cell, so that it gives no answer."
_RULE = (
    "The rule: within the trained volume, the best network of a cell is compared with the best other method, "
    f"seed by seed on the same data. It counts as better, or as worse, if its error differs by more than "
    f"{MARGIN - 1.0:.0%} in every seed."
)


def answer_parts(findings: Findings) -> list[Part]:
    """Return the answer in words, and the rule that it was computed by.

    Parameters
    ----------
    findings : Findings
    """
    sentences = findings.result.answer or (_NONE,)
    values = {"question": "Should I use a network?", "first": sentences[0], "others": sentences[1:]}
    quick = [Prose((_QUICK,), Tone.NOTE)] if findings.result.quick else []
    return [Written("bench_answer.html.jinja", values), Prose((_RULE,), Tone.QUIET), *quick]


_QUICK = (
    "This was a quick run: networks stop early in its plan. Run 'labcal bench distortion' without --quick "
    "for figures to quote."
)
