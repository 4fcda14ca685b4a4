"""Figures by family, method and strength: their region, their cells, and faults without a flag."""

from collections.abc import Callable
from dataclasses import replace

from labcal.bench.distortion.case import Cell, Layout, Measured
from labcal.bench.distortion.cell_summary import CellSummary
from labcal.bench.distortion.enough_points import least_of, with_enough_points
from labcal.bench.distortion.levels import spread_levels
from labcal.bench.distortion.result import family_figures

Make = Callable[..., CellSummary]
CELL = Cell("water", 0.5, 0.1, 140, Layout.PLANES)


def test_cells_with_too_few_points_do_not_count_where_others_have_enough(summary: Make) -> None:
    few, enough = (summary("dlt", (r,), cell=replace(CELL, points=n)) for r, n in ((9.0, 60), (2.0, 140)))
    (one,) = family_figures([few, enough])
    assert (one.over_oracle, one.worst, one.cells) == (2.0, 2.0, 1)
    assert with_enough_points([few]) == [few]
    assert (least_of([60, 200, 140]), least_of([60, 40])) == (140, 60)


def test_regions_are_apart(summary: Make) -> None:
    within, outside = summary("dlt", (2.0,)), replace(summary("dlt", (7.0,)), measured="outside")
    assert [one.worst for one in family_figures([within, outside])] == [2.0]
    assert [one.worst for one in family_figures([within, outside], Measured.OUTSIDE)] == [7.0]


def test_what_no_flag_warns_of_is_counted(summary: Make) -> None:
    cells = [
        summary("dlt", (2.1,), 0.5),
        replace(summary("dlt", (2.1,), 0.5), flagged_misfit=True, unflagged_coverage95=float("nan")),
        summary("dlt", (1.9,), 0.99),
        summary("dlt", (1.0,), 0.95),
        summary("dlt", (), float("nan"), reasons=("too few points",)),
    ]
    (one,) = family_figures(cells)
    assert one.missing == 1
    assert (one.cells, one.flagged, one.miscovered, one.overconfident, one.silent) == (5, 1, 2, 1, 1)


def test_spread_levels_keep_both_ends() -> None:
    assert spread_levels([0.4, 0.0, 1.0, 0.2, 0.0, 0.8, 0.6], 3) == [0.0, 0.4, 1.0]
    assert spread_levels([2, 1], 3) == [1, 2]
    assert spread_levels([2, 3, 1], 1) == [1]
