"""All causes and divisors from the data of all rows."""

from pathlib import Path

import numpy as np
import pytest

from labcal.paper.explanations import explained as module
from labcal.paper.explanations.board_problem import board_problem
from labcal.paper.explanations.causes import CAUSES
from labcal.paper.explanations.explained import PICTURED_ROWS, explained, undisturbed_outcomes
from labcal.paper.problem import Problem
from labcal.paper.row_runs import row_runs
from labcal.paper.rows import Data, row_named
from labcal.paper.training_run import run_training
from labcal.report.figure_readings import FigureReading
from labcal.run.executor import open_executor
from labcal.run.progress import NoProgress

Problems = dict[Data, dict[str, Problem]]


@pytest.mark.slow
def test_every_row_has_every_cause_and_a_quotient(
    problems: Problems, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MAX_EPOCHS", 1)
    cases = [case for row in PICTURED_ROWS for case in row_runs(row, problems, range(1), 1)]
    outcomes = undisturbed_outcomes(cases, [run_training(case) for case in cases])
    assert list(outcomes) == list(PICTURED_ROWS)
    assert [len(of_row) for of_row in outcomes.values()] == [3, 1, 3, 1, 1, 1, 1]
    with open_executor(1, None) as executor:
        found = explained(problems, outcomes, tmp_path, range(1), executor, NoProgress())
    assert [one.cause for one in found.causes] == [cause.name for cause in CAUSES]
    for one in found.causes:
        assert {(row.exp, row.figure) for row in one.rows} == {
            (row.exp, figure) for row in PICTURED_ROWS for figure in FigureReading
        }
    assert len(found.quotients) == 2 * len(PICTURED_ROWS)
    assert len(list((tmp_path / "explanation-runs").glob("*.json"))) == 11 * len(CAUSES)


def test_only_the_first_problem_of_a_row_counts(problems: Problems) -> None:
    """Row 23 is tested at its positions, and between them."""
    first = problems[Data.STILL_POSITIONS][""]
    two = {Data.STILL_POSITIONS: {"at": first, "between": first}}
    cases = row_runs(row_named("23"), two, range(2), 1)
    outcomes = [run_training(case) for case in cases]
    assert undisturbed_outcomes(cases, outcomes) == {row_named("23"): outcomes[:2]}


def test_a_board_on_the_slide_is_where_the_cameras_see_it(problems: Problems) -> None:
    """The frame of row 23 stays with the target; its pixels are those of the lowered target."""
    problem = problems[Data.STILL_POSITIONS][""]
    board = board_problem(Data.STILL_POSITIONS, problem)
    seen = np.concatenate([camera.project(board.world).q for camera in board.cameras], axis=1)
    np.testing.assert_allclose(seen, problem.X, atol=1e-9)
