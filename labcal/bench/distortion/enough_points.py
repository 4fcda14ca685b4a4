"""Cells with enough training points for a method to be judged."""

from collections.abc import Sequence

from labcal.bench.distortion.cell_summary import CellSummary
from labcal.bench.distortion.checks import ENOUGH_POINTS


def least_points(summaries: Sequence[CellSummary]) -> int:
    """Return the number of training points from which on cells count; where none has as many, the most.

    Parameters
    ----------
    summaries : sequence of CellSummary
    """
    return min(ENOUGH_POINTS, max((one.cell.points for one in summaries), default=0))


def with_enough_points(summaries: Sequence[CellSummary]) -> list[CellSummary]:
    """Return the summaries of cells with at least :func:`least_points` training points."""
    least = least_points(summaries)
    return [one for one in summaries if one.cell.points >= least]
