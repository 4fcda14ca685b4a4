"""Section: outside the trained volume."""

from labcal.bench.distortion.case import Measured
from labcal.bench.distortion.cell_data import MARGIN
from labcal.bench.distortion.curves import error_figure
from labcal.bench.distortion.page.family_charts import ChartKind, family_charts
from labcal.bench.distortion.page.family_table import family_table
from labcal.bench.distortion.page.findings import Findings
from labcal.bench.distortion.page.winner_table import winner_table
from labcal.report.page.document import Section
from labcal.report.page.prose import Prose

_HOW = (
    f"Points outside the hull of the training points, up to {MARGIN:.0%} of the volume's sides beyond it. "
    "Error over the oracle's at the same points. labcal flags such points as extrapolated."
)


def outside_section(findings: Findings) -> Section | None:
    """Return the errors over the strength outside the trained volume, and which method wins there.

    Parameters
    ----------
    findings : Findings
    """
    enough = findings.enough
    kind = ChartKind(
        "outside",
        Measured.OUTSIDE,
        error_figure,
        "error over the oracle's outside the trained volume by strength, a line for each method",
        lambda one: one.cell.points == enough,
    )
    charts = family_charts(findings, kind)
    if not charts:
        return None
    result = findings.result
    parts = [
        family_table("families-outside", result.outside, result.plan.strengths),
        winner_table("winners-outside", result.winners, Measured.OUTSIDE),
    ]
    return Section("Outside the trained volume", [Prose((_HOW,)), *charts, *parts])
