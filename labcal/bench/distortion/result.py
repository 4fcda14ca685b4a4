"""The document ``results.json`` of ``labcal bench distortion``, and its table for people."""

from collections.abc import Sequence

import numpy as np
from pydantic import BaseModel, ConfigDict
from rich.console import Group
from rich.table import Table

from labcal.bench.distortion.case import Measured
from labcal.bench.distortion.cell_summary import CellSummary
from labcal.bench.distortion.checks import LOW_COVERAGE, coverage_is_wrong
from labcal.bench.distortion.enough_points import with_enough_points
from labcal.bench.distortion.levels import spread_levels
from labcal.bench.distortion.own_detections.result import OwnResult, own_table
from labcal.bench.distortion.plan import Plan
from labcal.bench.distortion.pooling import known_median
from labcal.bench.distortion.protocols.result import ProtocolResult
from labcal.bench.distortion.protocols.tables import protocol_table
from labcal.bench.distortion.sensitivity import Sensitivity
from labcal.bench.distortion.sensitivity_coverage import coverage_tables, coverage_words
from labcal.bench.distortion.sensitivity_table import sensitivity_table
from labcal.bench.distortion.winners import Winner
from labcal.bench.families.registry import FAMILIES
from labcal.report.bench import BenchResult, bench_table
from labcal.report.values import Measured as Figure

FAR = 2.0
"""Times the oracle's error, beyond which a method is far from it."""
_MOST_COLUMNS = 5


class FamilyFigures(BaseModel):
    """One method on one family and strength in one region: medians over all its cells."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    family: str
    method: str
    strength: float
    known_as: str
    over_oracle: Figure
    """Median of the cells' medians; of cells with 130 points or more, where there are any."""
    worst: Figure
    """Greatest of them."""
    coverage95: Figure
    """Median of the cells' coverages."""
    flagged: int
    """Cells in which every seed is flagged `model-misfit`."""
    cells: int
    missing: int = 0
    """Cells in which no seed has a figure, so that they count in none of these."""
    miscovered: int = 0
    """Cells with neither a coverage of 0.93 to 0.97 nor a flag."""
    overconfident: int = 0
    """Those of them with a coverage below 0.93: their ellipsoids are too small."""
    silent: int = 0
    """Cells with more than `FAR` times the oracle's error in which a seed is not flagged `model-misfit`."""


class DistortionResult(BenchResult):
    """Checks, and what they were measured by."""

    command: str
    """The command line that measures the same again."""
    plan: Plan
    plan_sha256: str
    first_seed: int
    cases: int
    answer: tuple[str, ...]
    """To "should I use a network?"."""
    families: tuple[FamilyFigures, ...]
    """Within the trained volume."""
    winners: tuple[Winner, ...]
    outside: tuple[FamilyFigures, ...] = ()
    """Outside the trained volume, as far as the plan measures there."""
    sensitivity: tuple[Sensitivity, ...] = ()
    """To faults of boards and of shooting."""
    rendered: tuple[FamilyFigures, ...] = ()
    """As `families`, of the cells that are measured through pictures."""
    protocols: tuple[ProtocolResult, ...] = ()
    """Protocols of others, with what their authors published."""
    detections: tuple[OwnResult, ...] = ()
    """Methods on detections of one's own."""


def family_figures(
    summaries: Sequence[CellSummary], region: Measured = Measured.WITHIN
) -> list[FamilyFigures]:
    """Return the figures of a region by family, method and strength."""
    groups: dict[tuple[str, str, float], list[CellSummary]] = {}
    for one in with_enough_points([one for one in summaries if one.measured == region]):
        groups.setdefault((one.cell.family, one.method, one.cell.strength), []).append(one)
    return [
        FamilyFigures(
            family=family,
            method=method,
            strength=strength,
            known_as=FAMILIES[family].known_as(strength),
            over_oracle=known_median([one.over_oracle for one in group]),
            worst=max((one.over_oracle for one in group if one.over_oracle >= 0.0), default=float("nan")),
            coverage95=known_median([one.coverage95 for one in group]),
            flagged=sum(one.flagged_misfit for one in group),
            cells=len(group),
            missing=sum(not one.over_oracle >= 0.0 for one in group),
            miscovered=sum(map(coverage_is_wrong, group)),
            overconfident=sum(one.unflagged_coverage95 < LOW_COVERAGE for one in group),
            silent=sum(one.over_oracle > FAR and not one.flagged_misfit for one in group),
        )
        for (family, method, strength), group in groups.items()
    ]


def distortion_table(result: DistortionResult) -> Group:
    """Return errors by family and method over the strength, the answer, and the checks, for people."""
    title = "RMS error over the oracle's, median, within the trained volume"
    tables = [_errors_table(result.families, title)]
    if result.rendered:
        tables.append(_errors_table(result.rendered, f"{title}, through pictures"))
    if result.sensitivity:
        tables.append(sensitivity_table(result.sensitivity))
        tables += coverage_tables(result.sensitivity)
    tables += [*map(own_table, result.detections), *map(protocol_table, result.protocols)]
    said = [*coverage_words(result.sensitivity), *result.answer]
    return Group(*tables, *said, bench_table(result))


def _errors_table(families: Sequence[FamilyFigures], title: str) -> Table:
    strengths = spread_levels([one.strength for one in families], _MOST_COLUMNS)
    table = Table(title=title)
    table.add_column("family")
    table.add_column("method", overflow="fold")
    for strength in strengths:
        table.add_column(f"{strength:g}", justify="right")
    figures = {(one.family, one.method, one.strength): one for one in families}
    before = None
    for family, method in dict.fromkeys((one.family, one.method) for one in families):
        cells = [_cell(figures.get((family, method, strength))) for strength in strengths]
        if before not in {None, family}:
            table.add_section()
        table.add_row("" if before == family else family, method, *cells)
        before = family
    table.caption = "Columns: strength. *: flagged model-misfit, from training data alone, in every cell."
    return table


def _cell(one: FamilyFigures | None) -> str:
    if one is None or not np.isfinite(one.over_oracle):
        return "-"
    digits = f"{one.over_oracle:.2f}" if one.over_oracle < 100.0 else f"{one.over_oracle:.0f}"  # noqa: PLR2004
    return digits + ("*" if one.flagged == one.cells else " ")
