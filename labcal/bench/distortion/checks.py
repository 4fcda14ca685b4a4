"""Checks of a benchmark of distortion against their limits."""

from collections.abc import Callable, Iterable, Sequence
from itertools import islice
from math import isnan

from labcal.bench.distortion.case import Measured
from labcal.bench.distortion.cell_summary import CellSummary, usual_cells
from labcal.report.bench import Check, at_most
from labcal.run.user_code import SEPARATOR
from labcal.wording import counted

HYBRID, HYBRID_LIMIT, ENOUGH_POINTS = "hybrid", 1.10, 130
LOW_COVERAGE, HIGH_COVERAGE = 0.93, 0.97
_MOST_NAMED = 8


def distortion_checks(summaries: Sequence[CellSummary]) -> list[Check]:
    """Return the checks; a figure of a cell is the median over its seeds, coverage is of all their points.

    Methods of one's own, and cells of pictures or with a fault, are measured and not checked, but for a
    figure or a reason in every cell.
    """
    checks = [_no_gap(summaries)]
    summaries = usual_cells(summaries)
    within = [one for one in summaries if one.measured == Measured.WITHIN]
    for family in dict.fromkeys(one.cell.family for one in within):
        judged = [one for one in within if one.cell.family == family and counts_for_hybrid(one)]
        if judged:
            worst = max(one.over_oracle if one.over_oracle > 0.0 else float("inf") for one in judged)
            name = f"hybrid, {family}: RMS error over the oracle's, worst of {counted(len(judged), 'cell')}"
            checks.append(at_most(name, worst, HYBRID_LIMIT))
    for method in dict.fromkeys(one.method for one in summaries if SEPARATOR not in one.method):
        cells = [one for one in summaries if one.method == method]
        wrong = sum(map(coverage_is_wrong, cells))
        name = f"{method}: cells with neither a coverage of 0.93 to 0.97 nor a flag, of {len(cells)}"
        checks.append(at_most(name, float(wrong), 0.0))
    return checks


def counts_for_hybrid(summary: CellSummary) -> bool:
    """Return whether a cell is one that `hybrid` is to be near the oracle in."""
    return (
        summary.method == HYBRID
        and summary.measured == Measured.WITHIN
        and summary.cell.points >= ENOUGH_POINTS
    )


def hybrid_is_far(summary: CellSummary) -> bool:
    """Return whether `hybrid` misses its limit in a cell."""
    return counts_for_hybrid(summary) and not summary.over_oracle <= HYBRID_LIMIT


def coverage_is_wrong(summary: CellSummary) -> bool:
    """Return whether covariances of a cell are wrong, and no flag warns of that.

    Seeds that are flagged do not count, nor does a method that states no covariance.
    """
    covered = summary.unflagged_coverage95
    return not isnan(covered) and not LOW_COVERAGE <= covered <= HIGH_COVERAGE


def failure_notes(summaries: Sequence[CellSummary]) -> list[str]:
    """Return which methods have no figure, and which cells miss a limit, the worst first, for people."""
    summaries = usual_cells(summaries)
    far = sorted(filter(hybrid_is_far, summaries), key=lambda one: -one.over_oracle)
    notes = _without_figures(summaries)
    notes += _noted("hybrid above 1.10 of the oracle", far, lambda one: f"{one.over_oracle:.3f}")
    for method in dict.fromkeys(one.method for one in summaries if SEPARATOR not in one.method):
        wrong = [one for one in summaries if one.method == method and coverage_is_wrong(one)]
        wrong.sort(key=lambda one: -abs(one.unflagged_coverage95 - 0.95))
        notes += _noted(
            f"{method}, coverage without a flag", wrong, lambda one: f"{one.unflagged_coverage95:.3f}"
        )
    return notes


def _no_gap(summaries: Iterable[CellSummary]) -> Check:
    empty = [one for one in summaries if not one.over_oracle >= 0.0 and not one.reasons]
    return at_most("cells with neither a figure nor a reason", float(len(empty)), 0.0)


def _without_figures(summaries: Sequence[CellSummary]) -> list[str]:
    """Return the first reason of each method that has no figure in any cell."""
    notes = []
    for method in dict.fromkeys(one.method for one in summaries):
        cells = [one for one in summaries if one.method == method]
        if any(one.over_oracle >= 0.0 for one in cells):
            continue
        reason = next((reason for one in cells for reason in one.reasons), "no reason is known")
        notes.append(f"{method} has no figure in any cell: {reason}")
    return notes


def _noted(what: str, cells: Sequence[CellSummary], figure: Callable[[CellSummary], str]) -> list[str]:
    if not cells:
        return []
    named = [f"{cell_name(one)}: {figure(one)}" for one in islice(cells, _MOST_NAMED)]
    more = len(cells) - len(named)
    return [f"{what}: " + "; ".join(named) + (f"; and {more} more" if more else "")]


def cell_name(summary: CellSummary) -> str:
    """Return the name of a cell, for people."""
    cell = summary.cell
    return (
        f"{cell.family} {cell.strength:g}, {cell.noise_px:g} px, {cell.points} points, {cell.layout}, "
        f"{summary.measured}"
    )
