"""Section: the best methods within the trained volume."""

from labcal.bench.distortion.case import Measured
from labcal.bench.distortion.page.findings import Findings
from labcal.bench.distortion.page.winner_table import winner_table
from labcal.report.page.document import Section


def winners_section(findings: Findings) -> Section | None:
    """Return which method wins where, and by how much.

    Parameters
    ----------
    findings : Findings
    """
    winners = findings.result.winners
    if not any(one.measured == Measured.WITHIN for one in winners):
        return None
    return Section("Which method wins, and by how much", [winner_table("winners", winners, Measured.WITHIN)])
