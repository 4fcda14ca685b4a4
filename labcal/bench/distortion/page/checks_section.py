"""Section: figures against their limits, and cells without a figure."""

from labcal.bench.distortion.page.findings import Findings
from labcal.report.page.document import Section
from labcal.report.page.part import Part
from labcal.report.page.prose import Prose, Tone
from labcal.report.page.table import Column, PageTable, Side
from labcal.wording import counted

_MOST_REASONS = 30


def checks_section(findings: Findings) -> Section:
    """Return every check with its limit, the cells that miss one, and why cells have no figures.

    Parameters
    ----------
    findings : Findings
    """
    result = findings.result
    good = len(result.checks) - result.failed
    rows = [
        [one.name, f"{one.value:.4g}", f"{one.limit:g}", "kept" if one.ok else "missed"]
        for one in result.checks
    ]
    columns = [Column("check", Side.WIDE), Column("value"), Column("limit"), Column("", Side.LEFT)]
    caption = f"{good} of {counted(len(result.checks), 'check')} within their limits."
    parts: list[Part] = [PageTable("checks", caption, columns, rows)]
    parts += [Prose((f"{note}.",), Tone.QUIET) for note in result.notes]
    reasons = _reasons(findings)
    return Section("Checks", [*parts, *reasons])


def _reasons(findings: Findings) -> list[Part]:
    """Return a table of why methods have no figures, none where all have."""
    counts: dict[tuple[str, str], int] = {}
    for one in findings.summaries:
        for reason in one.reasons:
            counts[one.method, reason] = counts.get((one.method, reason), 0) + 1
    if not counts:
        return []
    first = list(counts.items())[:_MOST_REASONS]
    rows = [[method, str(number), reason] for (method, reason), number in first]
    more = f" The first {_MOST_REASONS} of {len(counts)}." if len(counts) > _MOST_REASONS else ""
    columns = [Column("method", Side.LEFT), Column("cells"), Column("reason", Side.WIDE)]
    return [PageTable("reasons", f"Cells with seeds without a figure, and why.{more}", columns, rows)]
