"""Figures of a cell over its seeds: medians and ranges of errors, pooled coverage."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from labcal.bench.distortion.case import Cell
from labcal.bench.distortion.lines import Line
from labcal.bench.distortion.pooling import known_median, pooled_coverage


@dataclass(frozen=True)
class CellSummary:
    """One method in one region of one cell.

    Attributes
    ----------
    seeds : int
    over_oracle : float
        Median over the seeds; NaN where no seed has a figure.
    low, high : float
        The least and the greatest of the seeds.
    rmse_mm : float
        Median.
    oracle_mm : float
        Median.
    coverage95 : float
        Of the points of all seeds together; NaN where no covariance is stated.
    unflagged_coverage95 : float
        Of the points of the seeds that are not flagged; NaN where all are.
    flagged_misfit : bool
        Every seed is flagged `model-misfit`.
    trained : int
        Fewest training points of a seed.
    by_seed : tuple of float
        RMS error over the oracle's, in the order of the seeds.
    reasons : tuple of str
        Why seeds have no figures, each once.
    """

    method: str
    cell: Cell
    measured: str
    seeds: int
    over_oracle: float
    low: float
    high: float
    rmse_mm: float
    oracle_mm: float
    coverage95: float
    unflagged_coverage95: float
    flagged_misfit: bool
    trained: int
    by_seed: tuple[float, ...]
    reasons: tuple[str, ...]


def summarised(lines: Iterable[Line]) -> list[CellSummary]:
    """Return the summary of each method, cell and region, in the order of the first lines."""
    groups: dict[tuple[str, Cell, str], list[Line]] = {}
    for line in lines:
        groups.setdefault((line.method, line.cell, line.measured), []).append(line)
    return [_summary(group) for group in groups.values()]


def usual_cells(summaries: Iterable[CellSummary]) -> list[CellSummary]:
    """Return the summaries of cells with simulated points, in which nothing is wrong."""
    return [one for one in summaries if one.cell.is_usual]


def _summary(group: list[Line]) -> CellSummary:
    first = group[0]
    ratios = np.array([line.over_oracle for line in group])
    known = ratios[np.isfinite(ratios)]
    figures = [line.figures for line in group if line.figures is not None]
    low, middle, high = np.quantile(known, (0.0, 0.5, 1.0)).tolist() if len(known) else (np.nan,) * 3
    return CellSummary(
        method=first.method,
        cell=first.cell,
        measured=first.measured,
        seeds=len(group),
        over_oracle=middle,
        low=low,
        high=high,
        rmse_mm=known_median([one.rmse_mm for one in figures]),
        oracle_mm=known_median([one.oracle_mm for one in figures]),
        coverage95=pooled_coverage(line.figures for line in group),
        unflagged_coverage95=pooled_coverage(line.figures for line in group if not is_flagged(line)),
        flagged_misfit=all(line.misfit is True for line in group),
        trained=min(line.trained for line in group),
        by_seed=tuple(ratios.tolist()),
        reasons=tuple(dict.fromkeys(line.reason for line in group if line.reason is not None)),
    )


def is_flagged(line: Line) -> bool:
    """Return whether labcal warns of these points: `model-misfit`, or most of them `extrapolated`."""
    if line.misfit is True:
        return True
    one = line.figures
    return one is not None and 2 * one.extrapolated > one.predicted
