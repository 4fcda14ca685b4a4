"""Cells of the benchmark of the error budget: which are measured on more sets, and what is said of them."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from labcal.bench.groups import Bench, Findings
from labcal.bench.solve import budget
from labcal.bench.solve.budget import LEAST, MOST_SETS, QUICK_SETS, SETS, Cell, budget_findings, cell_check
from labcal.bench.solve.budget_set import BudgetFigures, BudgetSet
from labcal.run.progress import NoProgress

CELL = Cell("wide", "even", 25, "brown5")


def figures(points: float, planes: float = 0.95) -> BudgetFigures:
    return BudgetFigures(
        points=points,
        noise_alone=0.0,
        distances=0.95,
        planes=planes,
        motions=0.95,
        parameters=1.0,
        warned=True,
    )


def bench_of(folder: Path, *, quick: bool) -> Bench:
    return Bench(quick=quick, seed=7, folder=folder, progress=NoProgress())


@pytest.fixture
def simulated(monkeypatch: pytest.MonkeyPatch) -> list[BudgetSet]:
    """The cases that were measured, of which the first sets of one cell are low by chance."""
    asked: list[BudgetSet] = []

    def measured(cases: Sequence[BudgetSet], *_: object) -> list[BudgetFigures]:
        asked.extend(cases)
        low = [
            Cell(one.kind, one.surface, one.views, one.lens) == CELL and one.seed < 7 + SETS for one in cases
        ]
        return [figures(0.8 if is_low else 0.96) for is_low in low]

    monkeypatch.setattr(budget, "run_cases", measured)
    monkeypatch.setattr(budget, "named_points_checks", lambda *_: [])
    monkeypatch.setattr(budget, "treatment_findings", lambda *_: Findings([], []))
    return asked


def test_a_cell_that_is_low_is_measured_on_more_sets(simulated: list[BudgetSet], tmp_path: Path) -> None:
    found = budget_findings(bench_of(tmp_path, quick=False))
    of_cell = [one.seed for one in simulated if Cell(one.kind, one.surface, one.views, one.lens) == CELL]
    assert of_cell == list(range(7, 7 + MOST_SETS))
    others = len(simulated) - len(of_cell)
    assert others == 23 * SETS
    (check,) = [check for check in found.checks if str(CELL) in check.name]
    assert f"{MOST_SETS} sets" in check.name
    assert check.ok
    assert check.limit == 0.0
    # The mean over all cells is that of the first sets: more of a low cell would weigh it down, or up.
    (mean,) = [check for check in found.checks if "coverage of points" in check.name]
    assert mean.value == pytest.approx(abs((20 * 0.96 + 0.8) / 21 - 0.95))


def test_a_quick_run_grants_chance_instead(simulated: list[BudgetSet], tmp_path: Path) -> None:
    budget_findings(bench_of(tmp_path, quick=True))
    assert len(simulated) == 24 * QUICK_SETS


def test_a_cell_is_judged_by_its_least_coverage() -> None:
    sets = [figures(0.95, planes) for planes in (0.8, 0.9, 0.9)]
    check = cell_check(CELL, sets, 0.0)
    assert "planes" in check.name
    assert not check.ok
    assert check.value == pytest.approx(LEAST - np.mean([0.8, 0.9, 0.9]))
    assert cell_check(CELL, sets, 2.6).ok
