"""The training runs of rows, and their summary."""

from collections.abc import Mapping, Sequence

from labcal.paper.problem import Problem
from labcal.paper.rows import Data, PaperRow, Solver
from labcal.paper.simulated import NoiseReading
from labcal.paper.summary import figures_of, row_result
from labcal.paper.training_run import TrainingOutcome, TrainingRun
from labcal.report.reproduction import RowResult

_PLANE_READINGS = ("affine", "quadratic", "homography")
_VOLUME_READINGS = ("affine", "quadratic", "dlt")
_VOLUMES = frozenset({Data.VOLUME, Data.VOLUME_RANDOM, Data.WEBCAM_VOLUME})


def methods_of(row: PaperRow) -> tuple[str, ...]:
    """Return the network, or the readings of "least squares" that can be computed on the data of a row."""
    if row.solver is Solver.NETWORK:
        return ("mlp",)
    return _VOLUME_READINGS if row.data in _VOLUMES else _PLANE_READINGS


def row_runs(
    row: PaperRow, problems: Mapping[Data, Mapping[str, Problem]], seeds: range, max_epochs: int
) -> list[TrainingRun]:
    """Return every training run of a row, reading by reading.

    Parameters
    ----------
    row : PaperRow
    problems : mapping of Data to mapping of str to Problem
        Of rows from pictures, by the name of the reading.
    seeds : range
    max_epochs : int
    """
    noises = (NoiseReading.SPREAD, NoiseReading.PIXEL) if row.noisy else (NoiseReading.NONE,)
    variants: dict[str, Problem | None] = {"": None}
    if row.pictured:
        variants = {**problems[row.data]}
    return [
        TrainingRun(row, method, noise, variant, problem, seed, max_epochs)
        for noise in noises
        for method in methods_of(row)
        for variant, problem in variants.items()
        for seed in seeds
    ]


def row_results(
    rows: Sequence[PaperRow],
    cases: Sequence[TrainingRun],
    outcomes: Sequence[TrainingOutcome],
    seeds: int,
) -> tuple[RowResult, ...]:
    """Return rows from the outcomes of their runs.

    Parameters
    ----------
    rows : sequence of PaperRow
    cases : sequence of TrainingRun
        Runs of other rows are left out.
    outcomes : sequence of TrainingOutcome
        One for each of `cases`.
    seeds : int
        Number of runs of each reading.
    """
    results = []
    for row in rows:
        readings: dict[str, list[TrainingOutcome]] = {}
        pixel_readings: dict[str, list[TrainingOutcome]] = {}
        for case, outcome in zip(cases, outcomes, strict=True):
            if case.row == row:
                kind = pixel_readings if case.noise is NoiseReading.PIXEL else readings
                kind.setdefault(case.reading, []).append(outcome)
        figures = [figures_of(reading, of_reading) for reading, of_reading in readings.items()]
        pixel_figures = [figures_of(reading, of_reading) for reading, of_reading in pixel_readings.items()]
        results.append(row_result(row, figures, pixel_figures, seeds))
    return tuple(results)
