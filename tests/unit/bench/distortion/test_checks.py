"""Checks: each fails in the cell that misses it, and in no other."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from labcal.bench.distortion.case import Cell, Layout
from labcal.bench.distortion.cell_summary import CellSummary, summarised
from labcal.bench.distortion.checks import distortion_checks, failure_notes
from labcal.bench.distortion.figures import RegionFigures
from labcal.bench.distortion.lines import Line

Make = Callable[..., CellSummary]
CELL = Cell("water", 0.5, 0.1, 140, Layout.PLANES)


def failed(summaries: list[CellSummary]) -> list[str]:
    return [check.name for check in distortion_checks(summaries) if not check.ok]


def test_good_cells_pass(summary: Make) -> None:
    assert failed([summary("hybrid", (1.02, 1.05, 1.2)), summary("dlt", (9.0, 9.0, 9.0))]) == []
    assert failure_notes([summary("hybrid", (1.02, 1.05, 1.2))]) == []


def test_a_hybrid_far_from_the_oracle_fails_where_there_are_points_enough(summary: Make) -> None:
    far = summary("hybrid", (1.05, 1.11, 1.2))
    few = summary("hybrid", (2.0, 2.0, 2.0), cell=replace(CELL, points=129))
    assert failed([far]) == ["hybrid, water: RMS error over the oracle's, worst of 1 cell"]
    assert failed([few]) == []
    assert failed([replace(few, measured="outside"), replace(far, measured="outside")]) == []
    assert "hybrid above 1.10 of the oracle: water 0.5, 0.1 px, 140 points" in failure_notes([far])[0]


def test_a_hybrid_without_a_figure_fails(summary: Make) -> None:
    assert len(failed([summary("hybrid", (), float("nan"), reasons=("too few",))])) == 1


@pytest.mark.parametrize(
    ("coverage", "good"), [(0.929, 0), (0.93, 1), (0.97, 1), (0.971, 0), (float("nan"), 1)]
)
def test_coverage_is_within_its_limits_or_not_stated_or_flagged(
    summary: Make, coverage: float, good: int
) -> None:
    assert len(failed([summary("dlt", (1.0,), coverage)])) == 1 - good
    assert failed([summary("my_module:Mine", (1.0,), coverage)]) == []


def test_a_cell_with_neither_figure_nor_reason_fails(summary: Make) -> None:
    nothing = summary("dlt", (), float("nan"))
    assert failed([nothing]) == ["cells with neither a figure nor a reason"]
    assert failed([replace(nothing, reasons=("too few points",))]) == []


def test_a_method_without_any_figure_is_named_with_its_reason(summary: Make) -> None:
    broken = summary("my_module:Mine", (), float("nan"), reasons=("its 'fit' failed [/b]",))
    elsewhere = replace(broken, cell=replace(CELL, strength=1.0))
    good = summary("dlt", (1.0,))
    assert failure_notes([broken, elsewhere, good]) == [
        "my_module:Mine has no figure in any cell: its 'fit' failed [/b]"
    ]
    assert failure_notes([broken, summary("my_module:Mine", (3.0,)), good]) == []


def line(covered: int, *, misfit: bool, extrapolated: int = 0, rmse_mm: float = 2.0) -> Line:
    figures = RegionFigures(
        measured="within", n=100, predicted=100, rmse_mm=rmse_mm, oracle_mm=1.0, stated=100,
        covered=covered, extrapolated=extrapolated,
    )  # fmt: skip
    return Line("dlt", CELL, 0, "within", figures, 140, 1.0, misfit, 2.0)


def test_a_cell_is_the_median_over_its_seeds_and_its_coverage_pooled() -> None:
    lines = [line(90, misfit=False, rmse_mm=1.0), line(40, misfit=True, rmse_mm=7.0), line(96, misfit=False)]
    (cell,) = summarised(lines)
    assert (cell.over_oracle, cell.low, cell.high) == (2.0, 1.0, 7.0)
    assert cell.coverage95 == pytest.approx(226 / 300)
    assert cell.unflagged_coverage95 == pytest.approx(186 / 200)
    assert not cell.flagged_misfit
    (outside,) = summarised([line(50, misfit=False, extrapolated=51)])
    assert outside.unflagged_coverage95 != outside.unflagged_coverage95
