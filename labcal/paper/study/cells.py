"""The summary of the study: medians and ranges over the seeds of every network."""

from collections.abc import Sequence
from concurrent.futures import Executor
from itertools import pairwise
from pathlib import Path

from labcal.paper.rows import PaperRow
from labcal.paper.study.topologies import StudyRun, study_runs, train_topology
from labcal.paper.summary import figures_of
from labcal.paper.training_run import TrainingOutcome
from labcal.report.study import StudyCell
from labcal.run.cases import run_cases
from labcal.run.progress import Progress

_INPUTS, _OUTPUTS = 4, 3


def studied(
    folder: Path, seeds: range, max_epochs: int, executor: Executor, progress: Progress
) -> tuple[StudyCell, ...]:
    """Train every network of the study, and return its figures.

    Parameters
    ----------
    folder : Path
        Where results of single runs are kept, in ``study-runs``; those of an interrupted run are used.
    seeds : range
    max_epochs : int
    executor : Executor
    progress : Progress
    """
    runs = study_runs(seeds, max_epochs)
    found = run_cases(runs, train_topology, TrainingOutcome, folder / "study-runs", executor, progress)
    return study_cells(runs, found)


def study_cells(runs: Sequence[StudyRun], outcomes: Sequence[TrainingOutcome]) -> tuple[StudyCell, ...]:
    """Return the figures of every network, in the order of the runs.

    Parameters
    ----------
    runs : sequence of StudyRun
    outcomes : sequence of TrainingOutcome
        One for each run.
    """
    of_cell: dict[tuple[str, tuple[int, ...]], list[TrainingOutcome]] = {}
    for run, outcome in zip(runs, outcomes, strict=True):
        of_cell.setdefault((run.exp, run.hidden), []).append(outcome)
    rows = {(run.exp, run.hidden): run.row for run in runs}
    return tuple(_cell(rows[key], of_network) for key, of_network in of_cell.items())


def _cell(row: PaperRow, outcomes: Sequence[TrainingOutcome]) -> StudyCell:
    figures = figures_of("mlp", outcomes)
    return StudyCell(
        exp=row.exp,
        data=row.data + (", 5% noise" if row.noisy else ""),
        points=row.points,
        goal=row.goal or 0.0,
        layers=len(row.hidden),
        neurons=sum(row.hidden),
        network="-".join(map(str, (*row.hidden, _OUTPUTS))),
        parameters=parameters(row.hidden),
        seeds=len(outcomes),
        reached=sum(bool(outcome.goal_reached) for outcome in outcomes),
        rmse_mm=figures.rmse_mm,
        rmse_range_mm=figures.rmse_range_mm,
        mean_signed_m=figures.mean_signed_m,
        mean_signed_range_m=figures.mean_signed_range_m,
        epochs=figures.epochs or 0.0,
        epochs_range=figures.epochs_range or (0.0, 0.0),
        seconds=figures.seconds,
        seconds_range=figures.seconds_range,
    )


def parameters(hidden: Sequence[int]) -> int:
    """Return the number of weights and biases of a network with 4 inputs and 3 outputs."""
    sizes = (_INPUTS, *hidden, _OUTPUTS)
    return sum((before + 1) * after for before, after in pairwise(sizes))
