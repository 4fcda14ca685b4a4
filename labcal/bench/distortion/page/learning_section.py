"""Section: errors as training points grow in number."""

from labcal.bench.distortion.case import Measured
from labcal.bench.distortion.curves import learning_figure
from labcal.bench.distortion.levels import spread_levels
from labcal.bench.distortion.page.family_charts import ChartKind, family_charts
from labcal.bench.distortion.page.findings import Findings
from labcal.report.page.document import Section
from labcal.report.page.prose import Prose

_MOST_STRENGTHS = 3
_HOW = (
    "The same error over the number of training points: without distortion, in between, and at its worst, as "
    "far as the plan has them. Where a line is flat and high, more points do not help; another method may."
)


def learning_section(findings: Findings) -> Section | None:
    """Return the learning curves by family; None of a plan with one number of points.

    Parameters
    ----------
    findings : Findings
    """
    if len(findings.result.plan.points) == 1:
        return None
    strengths = spread_levels(findings.result.plan.strengths, _MOST_STRENGTHS)
    kind = ChartKind(
        "learning",
        Measured.WITHIN,
        learning_figure,
        "error over the oracle's by training points, a line for each method",
        lambda one: one.cell.strength in strengths,
    )
    charts = family_charts(findings, kind)
    return Section("Error as training points are added", [Prose((_HOW,)), *charts]) if charts else None
