"""The document ``results.json`` of ``labcal bench distortion``, and its table for people."""

from collections.abc import Sequence

import numpy as np
from pydantic import BaseModel, ConfigDict
from rich.console import Group
from rich.table import Table

from labcal.bench.distortion.case import Measured
from labcal.bench.distortion.cell_summary import CellSummary
from labcal.bench.distortion.checks import ENOUGH_POINTS
from labcal.bench.distortion.own_detections.result import OwnResult, own_table
from labcal.bench.distortion.plan import Plan
from labcal.bench.distortion.protocols.result import ProtocolResult
from labcal.bench.distortion.protocols.tables import protocol_table
from labcal.bench.distortion.winners import Winner
from labcal.bench.families.registry import FAMILIES
from labcal.report.bench import BenchResult, bench_table
from labcal.report.values import Measured as Figure

_MOST_COLUMNS = 5


class FamilyFigures(BaseModel):
    """One method on one family and strength: medians over all its cells, within the trained volume."""

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


class DistortionResult(BenchResult):
    """Checks, and what they were measured by."""

    plan: Plan
    plan_sha256: str
    first_seed: int
    cases: int
    answer: tuple[str, ...]
    """To "should I use a network?"."""
    families: tuple[FamilyFigures, ...]
    winners: tuple[Winner, ...]
    protocols: tuple[ProtocolResult, ...] = ()
    """Protocols of others, with what their authors published."""
    detections: tuple[OwnResult, ...] = ()
    """Methods on detections of one's own."""


def family_figures(summaries: Sequence[CellSummary]) -> list[FamilyFigures]:
    """Return the figures by family, method and strength."""
    within = [one for one in summaries if one.measured == Measured.WITHIN]
    most = max((one.cell.points for one in within), default=0)
    enough = [one for one in within if one.cell.points >= min(ENOUGH_POINTS, most)]
    groups: dict[tuple[str, str, float], list[CellSummary]] = {}
    for one in enough:
        groups.setdefault((one.cell.family, one.method, one.cell.strength), []).append(one)
    return [
        FamilyFigures(
            family=family,
            method=method,
            strength=strength,
            known_as=FAMILIES[family].known_as(strength),
            over_oracle=_median([one.over_oracle for one in group]),
            worst=max((one.over_oracle for one in group if one.over_oracle >= 0.0), default=float("nan")),
            coverage95=_median([one.coverage95 for one in group]),
            flagged=sum(one.flagged_misfit for one in group),
            cells=len(group),
        )
        for (family, method, strength), group in groups.items()
    ]


def _median(values: Sequence[float]) -> float:
    known = [value for value in values if np.isfinite(value)]
    return float(np.median(known)) if known else float("nan")


def distortion_table(result: DistortionResult) -> Group:
    """Return errors by family and method over the strength, the answer, and the checks, for people."""
    strengths = _shown(sorted({one.strength for one in result.families}))
    table = Table(title="RMS error over the oracle's, median, within the trained volume")
    table.add_column("family")
    table.add_column("method", overflow="fold")
    for strength in strengths:
        table.add_column(f"{strength:g}", justify="right")
    figures = {(one.family, one.method, one.strength): one for one in result.families}
    before = None
    for family, method in dict.fromkeys((one.family, one.method) for one in result.families):
        cells = [_cell(figures.get((family, method, strength))) for strength in strengths]
        if before not in {None, family}:
            table.add_section()
        table.add_row("" if before == family else family, method, *cells)
        before = family
    table.caption = "Columns: strength. *: flagged model-misfit, from training data alone, in every cell."
    others = [*map(own_table, result.detections), *map(protocol_table, result.protocols)]
    return Group(table, *result.answer, *others, bench_table(result))


def _shown(strengths: list[float]) -> list[float]:
    """Return as many strengths as fit into a line, the least and the greatest among them."""
    if len(strengths) <= _MOST_COLUMNS:
        return strengths
    places = np.linspace(0, len(strengths) - 1, _MOST_COLUMNS).round().astype(int)
    return [strengths[place] for place in places]


def _cell(one: FamilyFigures | None) -> str:
    if one is None or not np.isfinite(one.over_oracle):
        return "-"
    digits = f"{one.over_oracle:.2f}" if one.over_oracle < 100.0 else f"{one.over_oracle:.0f}"  # noqa: PLR2004
    return digits + ("*" if one.flagged == one.cells else " ")
