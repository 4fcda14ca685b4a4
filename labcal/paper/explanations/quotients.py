"""Units and lengths of the experiment by which the printed errors may have been divided."""

from collections.abc import Callable, Mapping, Sequence
from statistics import median

import numpy as np

from labcal.paper.explanations.board_problem import BoardProblem
from labcal.paper.rows import Data, PaperRow
from labcal.paper.training_run import TrainingOutcome
from labcal.report.explanations import DivisorResult, QuotientRow
from labcal.report.figure_readings import FigureReading

DIVISORS: dict[str, Callable[[BoardProblem], float]] = {
    "metre (as printed)": lambda _: 1000.0,
    "foot": lambda _: 304.8,
    "decimetre": lambda _: 100.0,
    "inch": lambda _: 25.4,
    "centimetre": lambda _: 10.0,
    "millimetre": lambda _: 1.0,
    "a pixel on the board": lambda board: board.pixel_mm,
    "length of the board": lambda board: float(board.lengths_mm.max()),
    "mean coordinate of the tested points": lambda board: float(board.problem.Y_test[:, :3].mean()),
    "distance of the cameras": lambda board: board.camera_distance_mm,
}
"""Lengths in mm by their name."""


def quotient_rows(outcomes: Mapping[PaperRow, Sequence[TrainingOutcome]]) -> tuple[QuotientRow, ...]:
    """Return the length by which our error must be divided to give what is printed, row by row.

    Parameters
    ----------
    outcomes : mapping of PaperRow to sequence of TrainingOutcome
        Of all seeds, and of all methods of least squares.
    """
    return tuple(
        _quotient(row, figure, of_row) for figure in FigureReading for row, of_row in outcomes.items()
    )


def divisor_results(
    quotients: Sequence[QuotientRow], rows: Sequence[PaperRow], boards: Mapping[Data, BoardProblem]
) -> tuple[DivisorResult, ...]:
    """Return every named length with the rows that a division by it gives.

    A row is given if the length lies within the range of its quotients over seeds and methods.

    Parameters
    ----------
    quotients : sequence of QuotientRow
    rows : sequence of PaperRow
    boards : mapping of Data to BoardProblem
        The data of these rows.
    """
    results = []
    for name, length in DIVISORS.items():
        values = {row.exp: length(boards[row.data]) for row in rows}
        given: dict[str, list[str]] = {figure: [] for figure in FigureReading}
        for quotient in quotients:
            low, high = quotient.quotient_range_mm
            if low <= values[quotient.exp] <= high:
                given[quotient.figure].append(quotient.exp)
        results.append(
            DivisorResult(
                divisor=name,
                least_mm=min(values.values()),
                greatest_mm=max(values.values()),
                mean_signed_rows=tuple(given[FigureReading.MEAN_SIGNED]),
                coordinate_rows=tuple(given[FigureReading.COORDINATE]),
            )
        )
    return tuple(results)


def _quotient(row: PaperRow, figure: FigureReading, outcomes: Sequence[TrainingOutcome]) -> QuotientRow:
    errors = [
        abs(one.mean_signed_mm) if figure is FigureReading.MEAN_SIGNED else one.rmse_mm / np.sqrt(3.0)
        for one in outcomes
    ]
    printed = abs(row.paper_abs_m)
    return QuotientRow(
        exp=row.exp,
        figure=figure,
        printed=row.paper_abs_m,
        ours_mm=median(errors),
        quotient_mm=median(errors) / printed,
        quotient_range_mm=(min(errors) / printed, max(errors) / printed),
    )
