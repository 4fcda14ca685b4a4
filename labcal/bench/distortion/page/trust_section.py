"""Section: words on the reliability of each method."""

from labcal.bench.distortion.page.findings import Findings
from labcal.bench.distortion.trust_words import trust_entries
from labcal.report.page.document import Section
from labcal.report.page.prose import Prose, Terms, Tone

_ORACLE = (
    "The oracle triangulates the same noisy pixels with the true cameras: nothing can be much better. An "
    "error of 1 is the oracle's. Strength 0 is a pinhole camera, strength 1 the family at its worst."
)


def trust_section(findings: Findings) -> Section:
    """Return what each method can be trusted for, computed from its figures.

    Parameters
    ----------
    findings : Findings
    """
    points = (
        f"These words are about the strengths of the plan, in cells with {findings.enough} training points "
        "or more, over all noises and layouts. The flag model-misfit says that a method errs by more than "
        "noise explains, or that its covariances are too small; labcal raises it from training data alone."
    )
    return Section(
        "How far each method can be trusted",
        [Prose((_ORACLE,)), Terms(tuple(trust_entries(findings.result))), Prose((points,), Tone.QUIET)],
    )
