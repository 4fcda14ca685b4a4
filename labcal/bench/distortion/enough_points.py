"""Cells with enough training points for a method to be judged."""

from collections.abc import Sequence

from labcal.bench.distortion.cell_summary import CellSummary
from labcal.bench.distortion.checks import ENOUGH_POINTS


def least_of(levels: Sequence[int]) -> int:
    """Return the least level of training points with which cells count; the greatest where none is enough.

    Parameters
    ----------
    levels : sequence of int
        Of a plan.
    """
    return min((points for points in levels if points >= ENOUGH_POINTS), default=max(levels, default=0))


def with_enough_points(summaries: Sequence[CellSummary]) -> list[CellSummary]:
    """Return the summaries of cells with at least :func:`least_of` their training points."""
    least = least_of([one.cell.points for one in summaries])
    return [one for one in summaries if one.cell.points >= least]
