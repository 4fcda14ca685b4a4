"""The summary of all seeds for one row, next to the values of the paper: medians, reading, verdict."""

from collections.abc import Sequence
from statistics import median

from labcal.paper.rows import PaperRow, Solver
from labcal.paper.training_run import TrainingOutcome
from labcal.report.reproduction import Figures, RowResult

RESOLUTION_M = 1e-4
"""Below a tenth of a millimetre an error counts as none, as the paper's rounding to zero percent does."""
EPOCH_FACTOR = 2.0


def figures_of(reading: str, outcomes: Sequence[TrainingOutcome]) -> Figures:
    """Return the medians over seeds of one reading."""
    signed = [outcome.mean_signed_mm / 1e3 for outcome in outcomes]
    epochs = [outcome.epochs for outcome in outcomes if outcome.epochs is not None]
    reached = [outcome.goal_reached for outcome in outcomes if outcome.goal_reached is not None]
    return Figures(
        reading=reading,
        mean_signed_m=median(signed),
        rel=median(outcome.mean_signed_mm / outcome.mean_coordinate_mm for outcome in outcomes),
        mae_mm=median(outcome.mae_mm for outcome in outcomes),
        rmse_mm=median(outcome.rmse_mm for outcome in outcomes),
        p95_mm=median(outcome.p95_mm for outcome in outcomes),
        max_mm=median(outcome.max_mm for outcome in outcomes),
        epochs=median(epochs) if epochs else None,
        goal_reached=2 * sum(reached) > len(reached) if reached else None,
        seconds=median(outcome.seconds for outcome in outcomes),
        mean_signed_range_m=(min(signed), max(signed)),
        further_rmse=tuple(
            median(column) for column in zip(*(outcome.further_rmse for outcome in outcomes), strict=True)
        ),
    )


def row_result(
    row: PaperRow, readings: Sequence[Figures], pixel_readings: Sequence[Figures], seeds: int
) -> RowResult:
    """Return a row with the values of the paper.

    Parameters
    ----------
    row : PaperRow
    readings : sequence of Figures
        For least squares the one whose mean signed error is nearest to the paper's becomes the row; for a
        network the first.
    pixel_readings : sequence of Figures
        Readings that are shown and never become the row: noise of 5% of a pixel.
    seeds : int
        How many runs each reading's medians are of.
    """
    chosen = readings[0]
    if row.solver is Solver.LEAST_SQUARES:
        chosen = min(readings, key=lambda figures: abs(figures.mean_signed_m - row.paper_abs_m))
    outputs = 3 + len(chosen.further_rmse)
    return RowResult(
        exp=row.exp,
        solver=row.solver,
        data=row.data,
        points=row.points,
        network="-".join(map(str, (*row.hidden, outputs))) if row.hidden else None,
        goal=row.goal,
        seeds=seeds,
        reading=chosen.reading,
        epochs=chosen.epochs,
        paper_epochs=row.paper_epochs,
        goal_reached=chosen.goal_reached,
        mean_signed_m=chosen.mean_signed_m,
        mean_signed_range_m=chosen.mean_signed_range_m,
        rel=chosen.rel,
        paper_abs_m=row.paper_abs_m,
        paper_rel=row.paper_rel,
        mae_mm=chosen.mae_mm,
        rmse_mm=chosen.rmse_mm,
        p95_mm=chosen.p95_mm,
        max_mm=chosen.max_mm,
        seconds=chosen.seconds,
        verdict=_verdict(row, chosen),
        contradiction=row.contradiction,
        readings=(*readings, *pixel_readings),
    )


def _verdict(row: PaperRow, chosen: Figures) -> str:
    """Return whether the error is at most that of the paper, in about the same number of epochs."""
    if row.contradiction is not None:
        return "paper contradicts itself"
    if abs(chosen.mean_signed_m) > abs(row.paper_abs_m) + RESOLUTION_M:
        return "not reproduced"
    if row.paper_epochs is None or chosen.epochs is None:
        return "reproduced"
    if row.paper_epochs / EPOCH_FACTOR <= chosen.epochs <= row.paper_epochs * EPOCH_FACTOR:
        return "reproduced"
    return "reproduced in other epochs"
