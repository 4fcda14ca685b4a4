"""The summary of all cases of the causes: sizes over the seeds, and rows that share a cause."""

import math
from collections.abc import Mapping, Sequence
from statistics import median

from labcal.paper.explanations.cause_run import CauseOutcome, CauseRun, ReachedSize
from labcal.paper.explanations.causes import CAUSES, Cause
from labcal.paper.explanations.size import PRECISION
from labcal.paper.rows import PaperRow
from labcal.report.explanations import CauseResult, ExplainedRow
from labcal.report.figure_readings import FigureReading

_Sizes = Mapping[tuple[PaperRow, str, FigureReading], Sequence[ReachedSize]]
_MARGIN = 1.0 + 2.0 * PRECISION
"""Sizes within this factor are the same: both are solved for."""


def cause_results(runs: Sequence[CauseRun], outcomes: Sequence[CauseOutcome]) -> tuple[CauseResult, ...]:
    """Return every cause with the sizes that the rows need.

    Parameters
    ----------
    runs : sequence of CauseRun
    outcomes : sequence of CauseOutcome
        One for each run.
    """
    return tuple(_cause_result(cause, _sizes(cause, runs, outcomes)) for cause in CAUSES)


def _sizes(cause: Cause, runs: Sequence[CauseRun], outcomes: Sequence[CauseOutcome]) -> _Sizes:
    """Return the sizes of all seeds by row, method and reading of the printed figure."""
    found: dict[tuple[PaperRow, str, FigureReading], list[ReachedSize]] = {}
    for run, outcome in zip(runs, outcomes, strict=True):
        if run.cause == cause.name:
            found.setdefault((run.row, run.method, FigureReading.MEAN_SIGNED), []).append(outcome.mean_signed)
            found.setdefault((run.row, run.method, FigureReading.COORDINATE), []).append(outcome.coordinate)
    return found


def _cause_result(cause: Cause, sizes: _Sizes) -> CauseResult:
    readings = sorted(sizes, key=lambda key: list(FigureReading).index(key[2]))
    return CauseResult(
        cause=cause.name,
        words=cause.words,
        unit=cause.unit,
        likely=cause.likely,
        greatest=cause.sizes[-1],
        rows=tuple(_explained(cause, key, sizes) for key in readings),
    )


def _explained(cause: Cause, key: tuple[PaperRow, str, FigureReading], sizes: _Sizes) -> ExplainedRow:
    row, method, figure = key
    of_seeds = sizes[key]
    solved = [one.size for one in of_seeds if one.size is not None]
    middle = _median_size(of_seeds)
    greatest = [one.greatest_mm for one in of_seeds if one.greatest_mm is not None]
    return ExplainedRow(
        exp=row.exp,
        method=method,
        figure=figure,
        paper_m=row.paper_abs_m,
        size=middle,
        size_range=_finite_range(of_seeds),
        solved=len(solved),
        seeds=len(of_seeds),
        greatest_m=median(greatest) / 1e3 if greatest else math.nan,
        likely=cause.likely[0] <= middle <= cause.likely[1],
        also_gives=_also_given(middle, key, sizes),
    )


def _median_size(of_seeds: Sequence[ReachedSize]) -> float:
    """Return the median of the sizes, where none counts as infinite; NaN if that is the median."""
    middle = median(math.inf if one.size is None else one.size for one in of_seeds)
    return middle if math.isfinite(middle) else math.nan


def _finite_range(of_seeds: Sequence[ReachedSize]) -> tuple[float, float]:
    """Return the least and the greatest size; NaN in place of an end that has none."""
    sizes = [math.nan if one.size is None else one.size for one in of_seeds]
    solved = [size for size in sizes if not math.isnan(size)]
    return min(solved, default=math.nan), max(solved) if len(solved) == len(sizes) else math.nan


def _also_given(size: float, key: tuple[PaperRow, str, FigureReading], sizes: _Sizes) -> tuple[str, ...]:
    """Return the other rows that a size gives under the same reading of the printed figure."""
    row, _, figure = key
    given = {
        other.exp: None
        for (other, _, reading), of_seeds in sizes.items()
        if other != row and reading is figure and _holds(of_seeds, size)
    }
    return tuple(sorted(given))


def _holds(of_seeds: Sequence[ReachedSize], size: float) -> bool:
    """Return whether a size lies within the range of the seeds, give or take the precision of solving."""
    low, high = _finite_range(of_seeds)
    if math.isnan(low) or math.isnan(size):
        return False
    beyond = math.inf if math.isnan(high) else high
    return low / _MARGIN <= size <= beyond * _MARGIN
