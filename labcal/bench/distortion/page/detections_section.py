"""Section: detections of one's own."""

from labcal.bench.distortion.own_detections.result import OwnMethod, OwnResult
from labcal.bench.distortion.page.findings import Findings
from labcal.bench.distortion.trust_words import ratio_words
from labcal.report.page.document import Section
from labcal.report.page.download import table_download
from labcal.report.page.prose import Prose
from labcal.report.page.table import MISSING, Column, PageTable, Side

_HOW = (
    "Dots of your own views of a target on a stage. Views are held out, and all methods are trained on the "
    "rest. Errors are against the places that the stage gives, so that the errors of the stage are in them, "
    "and no oracle is known: errors are over the least of all methods."
)


def detections_section(findings: Findings) -> Section | None:
    """Return the errors of all methods, a table for each set of detections.

    Parameters
    ----------
    findings : Findings
    """
    results = findings.result.detections
    if not results:
        return None
    return Section("On detections of your own", [Prose((_HOW,)), *map(_table, results)])


def _table(result: OwnResult) -> PageTable:
    columns = [
        Column("method", Side.LEFT),
        *map(Column, ("RMS error (mm)", "over the best", "coverage", "expected (mm)", "extrapolated")),
    ]
    header = tuple(name for name in OwnMethod.model_fields if name != "reasons")
    lines = [[getattr(one, name) for one in result.methods] for name in header]
    caption = f"{result.name}; *: flagged model-misfit, from training data alone"
    file = table_download(f"detections-{result.name}.csv", header, lines)
    return PageTable(f"detections-{result.name}", caption, columns, list(map(_row, result.methods)), file)


def _row(one: OwnMethod) -> list[str]:
    name = one.method + ("*" if one.model_misfit else "")
    if not one.predicted:
        return [name, *[MISSING] * 5]
    covered = f"{one.coverage95:.3f}" if one.stated else MISSING
    expected = f"{one.expected_mm:.4g}" if one.expected_mm >= 0.0 else MISSING
    cells = [f"{one.rmse_mm:.4g}", ratio_words(one.over_best), covered, expected]
    return [name, *cells, f"{one.extrapolated} of {one.n}"]
