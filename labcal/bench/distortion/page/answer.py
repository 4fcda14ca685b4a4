"""The answer to "should I use a network?", above the sections of the page."""

from labcal.bench.distortion.network_answer import MARGIN
from labcal.bench.distortion.page.findings import Findings
from labcal.bench.distortion.page.plan_rows import setting_words
from labcal.report.page.part import Part
from labcal.report.page.prose import Prose, Tone
from labcal.report.page.written import Written

_NONE = (
    "This run does not say: no cell has figures of both a network and another method. Add networks "
    "to the plan, as with --method mlp-bayes,mlp."
)
_RULE = (
    "The rule: a cell is a combination of family, strength, noise, number of points and layout. Within the "
    "trained volume, the best network of a cell is compared with the best other method, seed by seed on the "
    f"same data. It counts as better, or as worse, if its error differs by more than "
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
    return [Written("bench_answer.html.jinja", values), Prose((_RULE,), Tone.QUIET), *_restrictions(findings)]


def _restrictions(findings: Findings) -> list[Part]:
    """Return what the answer is restricted by: settings of the plan, and a quick run."""
    settings = findings.result.plan.settings
    words = [f"{method} was measured with {setting_words(given)}." for method, given in settings.items()]
    if findings.result.quick:
        words.append(_QUICK)
    return [Prose(tuple(words), Tone.NOTE)] if words else []


_QUICK = (
    "This was a quick run, of few levels and seeds. For figures to quote, measure the levels that matter to "
    "you with more seeds, or the full plan on a cluster."
)
