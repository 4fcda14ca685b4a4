"""The summary of all seeds for one row, next to the values of the paper: medians, reading, verdict."""

from collections.abc import Sequence
from math import log10
from statistics import fmean, median

from labcal.paper.row_verdict import row_verdict
from labcal.paper.rows import PaperRow, Solver
from labcal.paper.simulated import NoiseReading
from labcal.paper.training_run import TrainingOutcome
from labcal.report.reproduction import Figures, LeastSquaresReading, RowResult


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
        mean_signed_range_m=_range(signed),
        mae_range_mm=_range([outcome.mae_mm for outcome in outcomes]),
        rmse_range_mm=_range([outcome.rmse_mm for outcome in outcomes]),
        p95_range_mm=_range([outcome.p95_mm for outcome in outcomes]),
        max_range_mm=_range([outcome.max_mm for outcome in outcomes]),
        epochs_range=_range(epochs) if epochs else None,
        seconds_range=_range([outcome.seconds for outcome in outcomes]),
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
        rel=chosen.rel,
        paper_abs_m=row.paper_abs_m,
        paper_rel=row.paper_rel,
        mae_mm=chosen.mae_mm,
        rmse_mm=chosen.rmse_mm,
        p95_mm=chosen.p95_mm,
        max_mm=chosen.max_mm,
        seconds=chosen.seconds,
        mean_signed_range_m=chosen.mean_signed_range_m,
        mae_range_mm=chosen.mae_range_mm,
        rmse_range_mm=chosen.rmse_range_mm,
        p95_range_mm=chosen.p95_range_mm,
        max_range_mm=chosen.max_range_mm,
        epochs_range=chosen.epochs_range,
        seconds_range=chosen.seconds_range,
        verdict=row_verdict(row, chosen),
        contradiction=row.contradiction,
        readings=(*readings, *pixel_readings),
    )


def _range(values: Sequence[float | int]) -> tuple[float, float]:
    """Return the least and the greatest of the seeds."""
    return float(min(values)), float(max(values))


def least_squares_readings(rows: Sequence[RowResult]) -> tuple[LeastSquaresReading, ...]:
    """Return how near each reading of "least squares" comes to the paper, over the rows that it has.

    Homography (on planes) and direct linear transform (in volumes) are one reading: a camera's geometry
    without distortion. Rows whose figures contradict each other count, too: their mean errors are printed.

    Parameters
    ----------
    rows : sequence of RowResult
        Rows with other methods are left out.
    """
    paper = {row.exp: row.paper_abs_m for row in rows}
    decades: dict[str, dict[str, float]] = {}
    for row in rows:
        if row.solver != Solver.LEAST_SQUARES:
            continue
        for figures in row.readings:
            method, _, noise = figures.reading.partition(", noise ")
            if noise == NoiseReading.PIXEL or not figures.mean_signed_m:
                continue
            ratio = abs(figures.mean_signed_m / paper[row.exp])
            decades.setdefault(_PROJECTIVE.get(method, method), {})[row.exp] = abs(log10(ratio))
    means = {reading: fmean(of_rows.values()) for reading, of_rows in decades.items()}
    return tuple(
        LeastSquaresReading(
            reading=reading,
            rows=tuple(decades[reading]),
            decades=mean,
            nearest=mean == min(means.values()),
        )
        for reading, mean in means.items()
    )


_PROJECTIVE = dict.fromkeys(("homography", "dlt"), "homography or dlt")
