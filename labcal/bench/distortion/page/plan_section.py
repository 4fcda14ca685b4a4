"""Section: the plan, and everything that was measured as files."""

import yaml

from labcal.bench.distortion.page.cell_table import cell_download
from labcal.bench.distortion.page.findings import Findings
from labcal.bench.distortion.page.plan_rows import plan_rows
from labcal.bench.distortion.plan import Plan
from labcal.report.page.document import Section
from labcal.report.page.download import Download
from labcal.report.page.files import Files
from labcal.report.page.prose import Prose
from labcal.report.page.table import Column, PageTable, Side
from labcal.run.json_text import to_json
from labcal.wording import counted

_MOST_BYTES = 10_000_000
"""Of results.csv in the page, which packs it into a sixth; a longer one stands beside it alone."""
_FILES = (
    "cells.csv has a line for each method, cell and region: medians over the seeds, and their range; "
    "results.csv a line for each seed. plan.yaml is the plan for --plan."
)


def plan_section(findings: Findings) -> Section:
    """Return the levels of every factor, the plan's hash, and files of all that was measured.

    Parameters
    ----------
    findings : Findings
    """
    result = findings.result
    levels = PageTable(
        "plan",
        f"Every combination is measured, each fault in its reference cells: {counted(result.cases, 'case')}.",
        [Column("factor", Side.LEFT), Column("levels", Side.WIDE)],
        plan_rows(result),
    )
    files = [
        Download("plan.yaml", plan_text(result.plan)),
        Download("results.json", to_json(result) + "\n"),
        cell_download("cells.csv", findings.summaries),
    ]
    if len(findings.results_csv) <= _MOST_BYTES:
        files.append(Download("results.csv", findings.results_csv))
    beside = "Beside this page, figures/ has every figure with all panels of the plan, and results.csv."
    return Section("The plan, and all files", [levels, Prose((_FILES, beside)), Files(tuple(files))])


def plan_text(plan: Plan) -> str:
    """Return a plan as the text of its file.

    Parameters
    ----------
    plan : Plan
    """
    text: str = yaml.safe_dump(plan.model_dump(mode="json"), sort_keys=False, allow_unicode=True)
    return text
