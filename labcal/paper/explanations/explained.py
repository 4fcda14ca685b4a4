"""All causes and divisors, run: sizes solved for, quotients of the undisturbed rows."""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from pathlib import Path

from labcal.paper.explanations.board_problem import board_problem
from labcal.paper.explanations.cause_results import cause_results
from labcal.paper.explanations.cause_run import CauseOutcome, CauseRun, solve_size
from labcal.paper.explanations.causes import CAUSES
from labcal.paper.explanations.quotients import divisor_results, quotient_rows
from labcal.paper.problem import Problem
from labcal.paper.row_runs import methods_of
from labcal.paper.rows import ROWS, Data, PaperRow
from labcal.paper.training_run import TrainingOutcome, TrainingRun
from labcal.report.explanations import Explanations
from labcal.run.cases import run_cases
from labcal.run.progress import Progress

MOST_SEEDS = 5
MAX_EPOCHS = 100
"""Accepted steps of a network at each size; more of them fit noise further, so that smaller sizes do."""
PICTURED_ROWS = tuple(row for row in ROWS if row.pictured)


def explained(
    problems: Mapping[Data, Mapping[str, Problem]],
    undisturbed: Mapping[PaperRow, Sequence[TrainingOutcome]],
    folder: Path,
    seeds: range,
    executor: Executor,
    progress: Progress,
) -> Explanations:
    """Solve for the size of every cause on every row from pictures, and divide.

    Parameters
    ----------
    problems : mapping of Data to mapping of str to Problem
        Of every kind of pictures; the first of each kind is used, as for the row.
    undisturbed : mapping of PaperRow to sequence of TrainingOutcome
        The rows without a mistake.
    folder : Path
        Where results of single cases are kept, in ``explanation-runs``; those of an interrupted run are used.
    seeds : range
        The first five are used.
    executor : Executor
    progress : Progress
    """
    boards = {data: board_problem(data, next(iter(of_data.values()))) for data, of_data in problems.items()}
    runs = [
        CauseRun(row, method, cause.name, boards[row.data], seed, MAX_EPOCHS)
        for cause in CAUSES
        for row in PICTURED_ROWS
        for method in methods_of(row)
        for seed in seeds[:MOST_SEEDS]
    ]
    outcomes = run_cases(runs, solve_size, CauseOutcome, folder / "explanation-runs", executor, progress)
    quotients = quotient_rows(undisturbed)
    return Explanations(
        causes=cause_results(runs, outcomes),
        quotients=quotients,
        divisors=divisor_results(quotients, PICTURED_ROWS, boards),
    )


def undisturbed_outcomes(
    cases: Sequence[TrainingRun], outcomes: Sequence[TrainingOutcome]
) -> dict[PaperRow, list[TrainingOutcome]]:
    """Return the outcomes of the rows from pictures without a mistake, of all seeds and methods.

    Where a row has several problems, those of the first are returned.

    Parameters
    ----------
    cases : sequence of TrainingRun
    outcomes : sequence of TrainingOutcome
        One for each of `cases`.
    """
    first: dict[PaperRow, str] = {}
    found: dict[PaperRow, list[TrainingOutcome]] = {}
    for case, outcome in zip(cases, outcomes, strict=True):
        if case.row.pictured and first.setdefault(case.row, case.variant) == case.variant:
            found.setdefault(case.row, []).append(outcome)
    return found
