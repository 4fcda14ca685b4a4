"""Section: coverage of the stated covariances."""

from labcal.bench.distortion.case import Measured
from labcal.bench.distortion.checks import HIGH_COVERAGE, LOW_COVERAGE
from labcal.bench.distortion.curves import coverage_figure
from labcal.bench.distortion.page.family_charts import ChartKind, family_charts
from labcal.bench.distortion.page.findings import Findings
from labcal.report.page.document import Section
from labcal.report.page.prose import Prose

_HOW = (
    "The share of errors within the 95% ellipsoids that a method states, of the points of all seeds "
    f"together. Right is 0.95; the band is {LOW_COVERAGE:g} to {HIGH_COVERAGE:g}. Open marks are flagged "
    "model-misfit: labcal warns that the ellipsoids are too small. Methods without a covariance have no line."
)


def coverage_section(findings: Findings) -> Section | None:
    """Return the coverage over the strength by family.

    Parameters
    ----------
    findings : Findings
    """
    enough = findings.enough
    kind = ChartKind(
        "coverage",
        Measured.WITHIN,
        coverage_figure,
        "coverage of 95% ellipsoids by strength, a line for each method",
        lambda one: one.cell.points == enough,
    )
    charts = family_charts(findings, kind)
    return Section("Can the stated uncertainty be believed?", [Prose((_HOW,)), *charts]) if charts else None
