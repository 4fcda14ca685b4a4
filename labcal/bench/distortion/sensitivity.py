"""Sensitivity of methods to faults that they do not know of, in pairs with data without the fault."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from pydantic import BaseModel, ConfigDict

from labcal.bench.distortion.case import NO_FAULT, Cell, Measured, Source
from labcal.bench.distortion.lines import Line
from labcal.bench.distortion.pooling import known_median, pooled_coverage
from labcal.bench.faults.registry import fault_named
from labcal.report.values import Measured as Figure

Pair = tuple[Line, Line]
"""One seed with a fault and without."""


class Sensitivity(BaseModel):
    """One method with one fault in one cell, within the trained volume.

    Errors of the pair are those at the same points with the same noise. What the fault adds is taken by
    squares, since it is independent of the noise: ``sqrt(rmse^2 - rmse_without^2)``, of the mean squares of
    all seeds.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    method: str
    family: str
    strength: float
    noise_px: float
    points: int
    source: str
    fault: str
    """The name with the size."""
    kind: str
    size: float | None
    """None for a fault that has no size."""
    rmse_mm: Figure
    """RMS error with the fault; of the mean square of all seeds."""
    usual_mm: Figure
    """The same without it."""
    over_usual: Figure
    """Error with the fault over that without it: median over the seeds."""
    added_mm: Figure
    """Error that the fault adds; 0 where the error is not larger with it."""
    added_mm_per_step: Figure
    """The same for the part of the size that `per` names, as if errors grew with the size."""
    per: str
    coverage95: Figure
    """Of the 95% ellipsoids with the fault, the points of all seeds together."""
    usual_coverage95: Figure
    """The same without it."""
    expected_mm: Figure
    """Expected RMS error with the fault, from training data alone: median over the seeds."""
    misfit: int
    """Seeds that are flagged `model-misfit` with the fault."""
    usual_misfit: int
    """Seeds that are flagged without it."""
    refused: int
    """Seeds whose data the method refuses with the fault."""
    seeds: int
    """Seeds with figures with the fault and without."""
    reasons: tuple[str, ...]
    """The reasons why seeds have no figures, each once."""

    @property
    def label(self) -> str:
        """The fault with the origin of the pixels, for people."""
        return self.fault if self.source == Source.SIMULATED else f"{self.fault}, {self.source}"

    @property
    def is_noticed(self) -> bool:
        """True if a seed is refused, or more seeds are flagged `model-misfit` than without the fault."""
        return self.refused > 0 or self.misfit > self.usual_misfit


def sensitivities(lines: Iterable[Line]) -> list[Sensitivity]:
    """Return the sensitivity of each method to each fault in each cell, in the order of the lines."""
    within = [line for line in lines if line.measured == Measured.WITHIN]
    without = {(line.method, line.cell, line.seed): line for line in within if line.cell.fault == NO_FAULT}
    groups: dict[tuple[str, Cell], list[Pair]] = {}
    for line in within:
        if line.cell.fault == NO_FAULT:
            continue
        usual = without.get((line.method, replace(line.cell, fault=NO_FAULT), line.seed))
        if usual is not None:
            groups.setdefault((line.method, line.cell), []).append((line, usual))
    return [_sensitivity(pairs) for pairs in groups.values()]


def _sensitivity(group: Sequence[Pair]) -> Sensitivity:
    first = group[0][0]
    cell, fault = first.cell, fault_named(first.cell.fault)
    pairs = [pair for pair in group if all(_error(line) >= 0.0 for line in pair)]
    lines, usual = [pair[0] for pair in pairs], [pair[1] for pair in pairs]
    rmse, before = _rms(map(_error, lines)), _rms(map(_error, usual))
    added = float(np.sqrt(max(0.0, rmse**2 - before**2))) if pairs else float("nan")
    return Sensitivity(
        method=first.method,
        family=cell.family,
        strength=cell.strength,
        noise_px=cell.noise_px,
        points=cell.points,
        source=str(cell.source),
        fault=cell.fault,
        kind=fault.kind.name,
        size=fault.size if fault.kind.has_size else None,
        rmse_mm=rmse,
        usual_mm=before,
        over_usual=known_median([_error(line) / _error(other) for line, other in pairs]),
        added_mm=added,
        added_mm_per_step=added * fault.kind.step / fault.size,
        per=fault.kind.per,
        coverage95=pooled_coverage(line.figures for line in lines),
        usual_coverage95=pooled_coverage(line.figures for line in usual),
        expected_mm=known_median([line.expected_mm for line in lines]),
        misfit=sum(line.misfit is True for line in lines),
        usual_misfit=sum(line.misfit is True for line in usual),
        refused=sum(_is_refused(line) for line, other in group if other.figures is not None),
        seeds=len(pairs),
        reasons=tuple(dict.fromkeys(line.reason for pair in group for line in pair if line.reason)),
    )


def _is_refused(line: Line) -> bool:
    """Return whether a method has no figures of data that could be drawn."""
    return line.figures is None and line.trained > 0


def _error(line: Line) -> float:
    return float("nan") if line.figures is None else line.figures.rmse_mm


def _rms(values: Iterable[float]) -> float:
    squares = [value**2 for value in values]
    return float(np.sqrt(np.mean(squares))) if squares else float("nan")
