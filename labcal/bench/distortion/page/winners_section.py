"""Section: the best methods within the trained volume."""

from labcal.bench.distortion.case import Measured
from labcal.bench.distortion.page.findings import Findings
from labcal.bench.distortion.page.winner_table import WINNER_WORDS, winner_table
from labcal.report.page.document import Section
from labcal.report.page.prose import Prose


def winners_section(findings: Findings) -> Section | None:
    """Return which method wins where, and by how much.

    Parameters
    ----------
    findings : Findings
    """
    winners = findings.result.winners
    if not any(one.measured == Measured.WITHIN for one in winners):
        return None
    table = winner_table("winners", winners, Measured.WITHIN)
    return Section("Which method wins, and by how much", [Prose((WINNER_WORDS,)), table])
