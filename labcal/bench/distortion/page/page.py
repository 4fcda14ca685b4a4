"""The page of a benchmark of distortion."""

from labcal.bench.distortion.page.answer import answer_parts
from labcal.bench.distortion.page.findings import Findings
from labcal.bench.distortion.page.sections import SECTIONS
from labcal.report.page.document import Page
from labcal.report.page.provenance import Provenance

PAGE = "index.html"
"""Its name in the folder of results."""
_LEAD = (
    "Pairs of simulated cameras that depart from the pinhole step by step. Every method is trained on the "
    "same noisy pixels of points at known places, and measured on points that it was not trained on."
)


def distortion_page(findings: Findings) -> Page:
    """Return the page: the answer first, then what each method can be trusted for, and all that shows it.

    It needs nothing beside it. The same findings give the same page.

    Parameters
    ----------
    findings : Findings
    """
    sections = [section for make in SECTIONS if (section := make(findings)) is not None]
    return Page(
        title="Benchmark of distortion",
        heading="How far methods can be trusted as distortion grows",
        lead=_LEAD,
        sections=sections,
        provenance=Provenance.of(findings.result.command, ()),
        opening=answer_parts(findings),
    )
