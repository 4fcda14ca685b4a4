"""Section: the plan, and all figures as a file."""

from labcal.bench.distortion.page.cell_table import cell_download
from labcal.bench.distortion.page.findings import Findings
from labcal.bench.distortion.plan import Plan
from labcal.report.page.document import Section
from labcal.report.page.prose import Prose, Tone
from labcal.report.page.table import Column, PageTable, Side
from labcal.wording import counted

_FILES = (
    "The button saves a line for each method, cell and region: medians over the seeds, and their range. "
    "Beside this page, results.csv has a line for each seed, results.json the checks and winners, and "
    "figures/ every figure with all panels of the plan."
)


def plan_section(findings: Findings) -> Section:
    """Return the levels of every factor, the plan's hash, and the cells as a file.

    Parameters
    ----------
    findings : Findings
    """
    result = findings.result
    cells = cell_download("cells.csv", findings.summaries)
    levels = PageTable(
        "plan",
        f"Every combination is measured: {counted(result.cases, 'case')}.",
        [Column("factor", Side.LEFT), Column("levels", Side.WIDE)],
        _rows(result.plan, result.first_seed),
        cells,
    )
    words = (result.plan.description,) if result.plan.description else ()
    hashed = f"SHA-256 of the plan: {result.plan_sha256}"
    return Section("The plan", [Prose((*words, _FILES)), levels, Prose((hashed,), Tone.QUIET)])


def _rows(plan: Plan, first_seed: int) -> list[list[str]]:
    """Return what the plan says, factor by factor, as it was dumped: new factors come by themselves."""
    said = plan.model_dump(mode="json", exclude={"description", "settings", "seeds"})
    rows = [[factor, _levels(value)] for factor, value in said.items()]
    rows.append(["seeds", f"{plan.seeds}, from {first_seed}"])
    for method, settings in plan.settings.items():
        rows.append(
            [f"settings of {method}", ", ".join(f"{name} {value}" for name, value in settings.items())]
        )
    return rows


def _levels(value: object) -> str:
    if isinstance(value, list | tuple):
        return ", ".join(f"{one:g}" if isinstance(one, float) else str(one) for one in value)
    return str(value)
