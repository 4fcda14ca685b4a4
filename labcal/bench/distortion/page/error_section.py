"""Section: errors as the distortion grows."""

from labcal.bench.distortion.case import Measured
from labcal.bench.distortion.curves import error_figure
from labcal.bench.distortion.page.family_charts import ChartKind, family_charts
from labcal.bench.distortion.page.family_table import family_table
from labcal.bench.distortion.page.findings import Findings
from labcal.report.page.document import Section
from labcal.report.page.prose import Prose

_HOW = (
    "RMS error over the oracle's on points within the trained volume that were not trained on. Lines are "
    "medians over the seeds, bands their range. Open marks: labcal's flag model-misfit is raised, from "
    "training data alone."
)


def error_section(findings: Findings) -> Section | None:
    """Return the errors over the strength by family, and the table of all methods.

    Parameters
    ----------
    findings : Findings
    """
    enough = findings.enough
    kind = ChartKind(
        "error",
        Measured.WITHIN,
        error_figure,
        "error over the oracle's by strength, a line for each method",
        lambda one: one.cell.points == enough,
    )
    charts = family_charts(findings, kind)
    if not charts:
        return None
    table = family_table("families-within", findings.result.families, findings.result.plan.strengths)
    return Section("Error as distortion grows", [Prose((_HOW,)), *charts, table])
