"""Faults through pictures: their cells and bounds, and pictures to measure on that no fault touches."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from labcal.bench.distortion.case import Case, Cell, Layout, Measured, Pictures, Source
from labcal.bench.distortion.figures import RegionFigures
from labcal.bench.distortion.lines import Line
from labcal.bench.distortion.plan import load_plan
from labcal.bench.distortion.rendered_data import rendered_data
from labcal.bench.distortion.sensitivity import sensitivities
from labcal.bench.distortion.sensitivity_table import sensitivity_table
from labcal.cli.console import rendered
from labcal.errors import InputError

CELL = Cell("brown", 0.6, 0.0, 260, Layout.PLANES, Source.RENDERED)


def test_faults_through_pictures_have_the_middle_strength_of_each_rendered_family() -> None:
    changes = ["rendered.faults=out-of-focus,bend-2", "rendered.families=brown,water", "rendered.seeds=2"]
    section = load_plan("quick", [*changes, "rendered.strengths=0,0.3,1"]).rendered
    assert section is not None
    cells = list(section.cells())
    assert [(cell.family, cell.strength, cell.fault) for cell in cells[6:]] == [
        ("brown", 0.3, "out-of-focus-1"), ("brown", 0.3, "bend-2"),
        ("water", 0.3, "out-of-focus-1"), ("water", 0.3, "bend-2"),
    ]  # fmt: skip
    assert all(replace(cell, fault="none") in cells[:6] for cell in cells[6:])
    assert section.case_count == 2 * len(cells) == len(section.cases(load_plan("quick").cases(0)[0]))


@pytest.mark.parametrize(
    ("fault", "said"),
    [("stage-1", "cannot make the fault 'stage'"), ("out-of-fokus", "mean 'out-of-focus'")],
)
def test_what_cannot_be_rendered_is_refused_at_once(fault: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        load_plan("quick", [f"rendered.faults={fault}"])


def test_a_fault_through_pictures_is_a_line_of_its_own() -> None:
    one = RegionFigures(
        measured="within", n=9, predicted=9, rmse_mm=1.0, oracle_mm=1.0, stated=9, covered=9, extrapolated=0
    )
    lines = [
        Line("dlt", replace(CELL, source=source, fault=fault), 0, "within", replaced, 260)
        for source, rmse_mm in ((Source.SIMULATED, 2.0), (Source.RENDERED, 3.0))
        for fault, replaced in (("none", one), ("bend-1", one.model_copy(update={"rmse_mm": rmse_mm})))
    ]
    found = sensitivities(lines)
    assert [(each.label, each.over_usual) for each in found] == [("bend-1", 2.0), ("bend-1, rendered", 3.0)]
    shown = rendered(sensitivity_table(found), sys.stdout)
    assert [row.split("│")[1].strip() for row in shown.splitlines() if "bend" in row] == [
        "bend-1", "bend-1, rendered"
    ]  # fmt: skip


@pytest.mark.slow
def test_a_fault_is_in_the_pictures_to_train_on_alone() -> None:
    """The blur loses far planes; points count that are within the volume of the dots without it."""
    pictures = Pictures(views=3, spp=4)
    case = Case(CELL, 0, ("dlt",), (Measured.WITHIN,), 0, pictures=pictures)
    usual = rendered_data(case, pictures)
    found = rendered_data(replace(case, cell=replace(CELL, fault="out-of-focus-1")), pictures)
    one, other = (each.tests[Measured.WITHIN] for each in (usual, found))
    assert np.array_equal(one.p, other.p)
    assert np.array_equal(one.oracle, other.oracle)
    assert set(found.Y[:, 2]) < set(usual.Y[:, 2])
    where = {tuple(place): q for place, q in zip(usual.Y.tolist(), usual.X, strict=True)}
    moved = [q - where[tuple(place)] for place, q in zip(found.Y.tolist(), found.X, strict=True)]
    assert 1e-4 < np.sqrt((np.array(moved) ** 2).mean()) < 0.5
    assert found.pixel_error_px > usual.pixel_error_px
