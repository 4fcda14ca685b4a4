"""Sensitivity to faults: a known answer from the data to the figures, pairs, flags and refusals."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from labcal.bench.distortion.case import Case, Cell, Layout, Measured
from labcal.bench.distortion.cell_data import CellData, cell_data, lattice
from labcal.bench.distortion.figures import RegionFigures
from labcal.bench.distortion.lines import Line
from labcal.bench.distortion.measuring import region_figures
from labcal.bench.distortion.sensitivity import Sensitivity, sensitivities
from labcal.bench.distortion.sensitivity_coverage import coverage_tables, coverage_words, is_overconfident
from labcal.bench.distortion.sensitivity_figures import sensitivity_figure, sensitivity_figures
from labcal.bench.distortion.sensitivity_table import sensitivity_table
from labcal.bench.families.registry import family_by_name
from labcal.bench.families.volume import TABLE
from labcal.bench.faults.planned_planes import PlannedPlanes
from labcal.bench.faults.wrong_boards import bent
from labcal.cli.console import rendered
from labcal.errors import InputError
from labcal.estimators.dlt import Dlt
from labcal.report.inline_svg import GROUND

CELL = Cell("brown", 0.0, 1e-4, 140, Layout.PLANES)
CASE = Case(CELL, 3, ("dlt",), (Measured.WITHIN,), 300)


def data_with(fault: str, **changes: object) -> CellData:
    return cell_data(replace(CASE, cell=replace(CELL, fault=fault, **changes)))  # type: ignore[arg-type]


@pytest.mark.parametrize("excess", [0.01, 0.001])
def test_a_pitch_costs_an_exact_method_its_share_of_the_distance_from_dot_0_0(excess: float) -> None:
    """Told places are an affine map of the true ones, and what a linear camera sees of those is linear.

    So DLT fits without an error, and gives the declared place of every point: short by e / (1 + e) of its
    distance from dot (0, 0) along the board.
    """
    data = data_with(f"pitch-{excess}")
    found = region_figures(Dlt().fit(data.X, data.Y), data, Measured.WITHIN)
    p = data.tests[Measured.WITHIN].p
    distance = np.linalg.norm((p - data.Y.min(axis=0))[:, :2], axis=1)
    expected = excess / (1.0 + excess) * np.sqrt((distance**2).mean())
    assert found.rmse_mm == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize(
    "fault", ["pitch-1e-9", "bend-1e-8", "misprint-1e-8", "stage-1e-8", "camera-knocked-1e-9"]
)
def test_noise_and_tests_are_the_same_with_a_fault_and_without(fault: str) -> None:
    without, data = cell_data(CASE), data_with(fault)
    assert np.array_equal(data.Y, without.Y)
    assert 0.0 < np.abs(data.X - without.X).max() < 1e-4
    for name in ("p", "q", "oracle"):
        one, other = (getattr(each.tests[Measured.WITHIN], name) for each in (data, without))
        assert np.array_equal(one, other)


def test_dots_that_a_fault_moves_out_of_the_picture_are_left_out_and_take_their_noise_along() -> None:
    without, data = cell_data(CASE), data_with("bend-500")
    pair = family_by_name(CELL.family).pair(CELL.strength, CASE.seed)
    declared = TABLE.planes(*lattice(CELL.points))
    assert np.array_equal(declared, without.Y)
    exact = bent(PlannedPlanes.of(declared, pair, CASE.seed), 500.0)
    kept = (without.Y[:, None] == data.Y).all(axis=2).any(axis=1)
    assert 16 < kept.sum() == len(data.X) == len(data.Y) < len(without.Y)
    assert not kept[: len(data.Y)].all()
    noise = without.X - np.concatenate([camera.project(without.Y).q for camera in pair], axis=1)
    assert np.abs(data.X - exact[kept].reshape(-1, 4) - noise[kept]).max() < 1e-9
    with pytest.raises(InputError, match="takes the layout 'planes'"):
        data_with("pitch-0.5", layout=Layout.VOLUME)


def line(
    seed: int, rmse_mm: float, *, fault: str = "bend-2", misfit: bool = False, covered: int = 95
) -> Line:
    figures = RegionFigures(
        measured="within", n=100, predicted=100, rmse_mm=rmse_mm, oracle_mm=1.0, stated=100, covered=covered,
        extrapolated=0,
    )  # fmt: skip
    return Line("dlt", replace(CELL, fault=fault), seed, "within", figures, 140, 1.0, misfit, 2.0)


def sensitivity(*lines: Line) -> Sensitivity:
    (found,) = sensitivities(lines)
    return found


def test_what_a_fault_adds_is_taken_by_squares_and_per_unit_of_it() -> None:
    usual = [line(seed, 3.0, fault="none") for seed in (0, 1)]
    found = sensitivity(*usual, line(0, 5.0, covered=40), line(1, 5.0, covered=50, misfit=True))
    assert (found.rmse_mm, found.usual_mm, found.added_mm) == (5.0, 3.0, 4.0)
    assert found.over_usual == pytest.approx(5.0 / 3.0)
    assert (found.added_mm_per_step, found.per) == (2.0, "1 mm of sag")
    assert (found.coverage95, found.usual_coverage95) == (0.45, 0.95)
    assert (found.misfit, found.usual_misfit, found.refused, found.seeds) == (1, 0, 0, 2)
    assert found.is_noticed


def test_a_seed_counts_with_its_own_pair() -> None:
    """Of the seed 2 there is none without the fault, and of the seed 1 none with it."""
    usual = [line(0, 1.0, fault="none"), line(1, 100.0, fault="none")]
    found = sensitivity(*usual, line(0, 3.0), line(2, 77.0))
    assert (found.rmse_mm, found.usual_mm, found.over_usual, found.seeds) == (3.0, 1.0, 3.0, 1)


def test_a_smaller_error_with_the_fault_adds_nothing_and_is_noticed_by_nobody() -> None:
    found = sensitivity(line(0, 3.0, fault="none", misfit=True), line(0, 2.9, misfit=True))
    assert (found.added_mm, found.is_noticed) == (0.0, False)
    assert found.over_usual < 1.0


def test_a_refusal_is_noticed_and_has_its_reason() -> None:
    refused = replace(line(0, 1.0), figures=None, misfit=None, reason="contradiction")
    found = sensitivity(line(0, 1.0, fault="none"), refused)
    assert (found.refused, found.seeds, found.reasons) == (1, 0, ("contradiction",))
    assert found.is_noticed
    assert found.rmse_mm != found.rmse_mm


def test_data_that_could_not_be_drawn_are_no_refusal() -> None:
    found = sensitivity(
        line(0, 1.0, fault="none"), replace(line(0, 1.0), figures=None, trained=0, reason="no")
    )
    assert (found.refused, found.is_noticed, found.reasons) == (0, False, ("no",))


def test_points_outside_and_cells_without_a_fault_have_no_sensitivity() -> None:
    outside = [replace(line(0, 1.0, fault=fault), measured="outside") for fault in ("none", "bend-2")]
    assert sensitivities([line(0, 1.0, fault="none"), *outside]) == []


def test_table_and_figure_show_what_is_noticed_refused_and_not_measured() -> None:
    usual = line(0, 1.0, fault="none")
    noticed = line(0, 4.0, misfit=True)
    unnoticed = line(0, 5.0, fault="pitch-0.001")
    refused = replace(line(0, 1.0, fault="board-turned"), figures=None, reason="why")
    undrawn = replace(refused, cell=replace(CELL, fault="out-of-focus-1"), trained=0)
    found = sensitivities([usual, noticed, unnoticed, refused, undrawn])
    rows = [text.split("│")[1:3] for text in rendered(sensitivity_table(found), sys.stdout).splitlines()]
    assert [[cell.strip() for cell in row] for row in rows if len(row) == 2] == [
        ["bend-2", "4*"], ["pitch-0.001", "5"], ["board-turned", "refused*"], ["out-of-focus-1", "-"]
    ]  # fmt: skip
    (axes,) = sensitivity_figure(found, "title").axes
    marks = {tuple(mark.get_xydata()[0]): mark for mark in axes.lines if len(mark.get_xydata()) == 1}
    assert [(place, mark.get_markerfacecolor() == GROUND.drawn) for place, mark in marks.items()] == [
        ((4.0, 0.0), False), ((5.0, 1.0), True), ((0.985, 2.0), False)
    ]  # fmt: skip
    assert list(sensitivity_figures(found)) == ["sensitivity-brown.svg"]
    assert sensitivity_figures(found) == sensitivity_figures(found)
    assert sensitivity_figures([]) == {}


@pytest.mark.parametrize(
    ("covered", "flags"), [(80, (False, False)), (92, (False, False)), (80, (True, False))]
)
def test_ellipsoids_that_a_fault_makes_too_small_without_a_flag_are_told(
    covered: int, flags: tuple[bool, bool]
) -> None:
    usual = line(0, 1.0, fault="none", misfit=flags[0])
    found = sensitivity(usual, line(0, 4.0, covered=covered, misfit=flags[1]))
    assert is_overconfident(found)
    (words,) = coverage_words([found])
    assert "of dlt are too small with these faults, and nothing warns of it: bend-2 (" in words
    assert words.endswith(f"(coverage 0.{covered}0, 0.950 without it).")


@pytest.mark.parametrize(
    ("covered", "flags"),
    [
        (93, (False, False)),
        (100, (False, False)),
        (80, (False, True)),  # the flag warns
        (80, (True, True)),  # and it did before
    ],
)
def test_where_ellipsoids_are_right_or_flagged_that_is_told(covered: int, flags: tuple[bool, bool]) -> None:
    usual = line(0, 1.0, fault="none", misfit=flags[0])
    found = sensitivity(usual, line(0, 4.0, covered=covered, misfit=flags[1]))
    assert not is_overconfident(found)
    said = "Where nothing warns of a fault, 95% ellipsoids hold at least 93% of the errors."
    assert coverage_words([found]) == [said]


def test_the_table_of_coverage_marks_what_nothing_warns_of() -> None:
    usual = line(0, 1.0, fault="none")
    refused = replace(line(0, 1.0, fault="board-turned"), figures=None, reason="why")
    found = sensitivities(
        [usual, line(0, 4.0, covered=40, misfit=True), line(0, 5.0, fault="pitch-0.001", covered=60), refused]
    )
    (table,) = coverage_tables(found)
    rows = [text.split("│")[1:3] for text in rendered(table, sys.stdout).splitlines()]
    assert [[cell.strip() for cell in row] for row in rows if len(row) == 2] == [
        ["bend-2", "0.400"], ["pitch-0.001", "0.600!"], ["board-turned", "-"]
    ]  # fmt: skip
    unknown = [one.model_copy(update={"coverage95": float("nan")}) for one in found]
    assert coverage_tables(unknown) == coverage_words(unknown) == []
