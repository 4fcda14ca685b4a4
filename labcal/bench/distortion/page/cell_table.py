"""Summaries of cells as a file of the page."""

from collections.abc import Sequence

from labcal.bench.distortion.cell_summary import CellSummary
from labcal.report.page.download import Download, table_download

HEADER = (
    *("method", "family", "strength", "noise_px", "points", "layout", "source", "fault", "measured", "seeds"),
    *("trained", "over_oracle", "low", "high", "rmse_mm", "oracle_mm"),
    *("coverage95", "unflagged_coverage95", "model_misfit", "reason"),
)


def cell_download(file: str, summaries: Sequence[CellSummary]) -> Download:
    """Return a line for each method, cell and region: medians over the seeds, with their range.

    Parameters
    ----------
    file : str
        Its name.
    summaries : sequence of CellSummary
    """
    lines = map(_line, summaries)
    return table_download(file, HEADER, list(zip(*lines, strict=True)) or [()] * len(HEADER))


def _line(one: CellSummary) -> tuple[object, ...]:
    cell = one.cell
    factors = (one.method, cell.family, cell.strength, cell.noise_px, cell.points, str(cell.layout))
    where = (str(cell.source), cell.fault, one.measured, one.seeds)
    errors = (one.trained, one.over_oracle, one.low, one.high, one.rmse_mm, one.oracle_mm)
    coverage = (one.coverage95, one.unflagged_coverage95, int(one.flagged_misfit), "; ".join(one.reasons))
    return (*factors, *where, *errors, *coverage)
