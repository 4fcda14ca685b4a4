"""The best method of every cell, and by how much, in pairs over the seeds."""

from collections.abc import Sequence

import numpy as np
from pydantic import BaseModel, ConfigDict

from labcal.bench.distortion.cell_summary import CellSummary
from labcal.report.values import Measured as Figure


class Winner(BaseModel):
    """The best method of a cell and region."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    family: str
    strength: float
    noise_px: float
    points: int
    layout: str
    measured: str
    best: str | None
    """The method with the least median; None where no method has a figure."""
    over_oracle: Figure
    """Its median RMS error over the oracle's."""
    second: str | None
    second_over_best: Figure
    """Median over the seeds of the second method's error over the best one's, on the same data."""
    seeds_won: int
    """Seeds in which the best method has the smaller error of the two."""
    seeds: int


def winners(summaries: Sequence[CellSummary]) -> list[Winner]:
    """Return the best method of every cell and region."""
    groups: dict[tuple[object, str], list[CellSummary]] = {}
    for one in summaries:
        groups.setdefault((one.cell, one.measured), []).append(one)
    return [_winner(group) for group in groups.values()]


def paired_ratios(one: CellSummary, other: CellSummary) -> np.ndarray:
    """Return the error of one method over another's, by seed; those without both are left out."""
    ratios = np.array(one.by_seed) / np.array(other.by_seed)
    return np.asarray(ratios[np.isfinite(ratios)])


def _winner(group: Sequence[CellSummary]) -> Winner:
    cell = group[0].cell
    known = sorted((one for one in group if one.over_oracle >= 0.0), key=lambda one: one.over_oracle)
    best = known[0] if known else None
    second = known[1] if len(known) > 1 else None
    ratios = paired_ratios(second, best) if best is not None and second is not None else np.zeros(0)
    return Winner(
        family=cell.family,
        strength=cell.strength,
        noise_px=cell.noise_px,
        points=cell.points,
        layout=str(cell.layout),
        measured=group[0].measured,
        best=None if best is None else best.method,
        over_oracle=float("nan") if best is None else best.over_oracle,
        second=None if second is None else second.method,
        second_over_best=float(np.median(ratios)) if len(ratios) else float("nan"),
        seeds_won=int((ratios > 1.0).sum()),
        seeds=group[0].seeds,
    )
