"""Measuring through pictures: the error of detected pixels, the lines, the figures, and one case whole."""

import csv
from collections.abc import Callable

import numpy as np
import pytest

from labcal.bench.distortion.case import Case, Cell, Layout, Measured, Pictures, Source
from labcal.bench.distortion.cell_data import CellData, RegionPoints
from labcal.bench.distortion.cell_summary import CellSummary
from labcal.bench.distortion.figures import CaseFigures, MethodFigures, RegionFigures
from labcal.bench.distortion.lines import lines_of, results_table
from labcal.bench.distortion.measuring import measured_case
from labcal.bench.distortion.rendered_curves import rendered_figures, rendered_notes
from labcal.bench.distortion.rendered_data import from_whole_corner, pixel_error
from labcal.correspond.matching import Matches
from labcal.shoot.truth import TrueDots

CELL = Cell("brown", 0.6, 0.0, 520, Layout.PLANES, Source.RENDERED)


def test_the_error_of_pixels_is_that_of_each_coordinate_in_whatever_order_the_truth_is() -> None:
    index = np.array([[0, 0], [1, 0], [2, 0]])
    centroid = np.array([[10.0, 20.0], [30.0, 40.0], [50.0, 60.0]])
    nowhere, seen_whole = np.zeros((3, 3)), np.ones(3, dtype=bool)
    back = slice(None, None, -1)
    truth = [
        TrueDots("a", name, index[back], nowhere, centroid[back] - 9.0, centroid[back] + far, seen_whole)
        for name, far in (("right", 100.0), ("left", 0.0))
    ]
    error = np.array([[[0.1, -0.2], [0.3, 0.0]], [[0.0, 0.4], [-0.1, 0.1]]])
    q = np.stack([centroid[1:], centroid[1:] + 100.0], axis=1) + error
    seen = Matches(("left", "right"), np.array(["a", "a"]), index[1:], q, np.tile(np.eye(2), (2, 2, 1, 1)))
    assert pixel_error(seen, truth) == pytest.approx(np.sqrt((error**2).mean()))


def test_pixels_of_pictures_with_a_margin_count_from_the_corner_of_the_whole() -> None:
    q = np.arange(12.0).reshape(3, 2, 2)
    points = RegionPoints(np.ones((3, 3)), q, np.zeros((3, 3)), np.tile(np.eye(2), (3, 2, 1, 1)))
    data = CellData(q.reshape(3, 4), np.ones((3, 3)), {Measured.WITHIN: points}, 1.0)
    whole = from_whole_corner(data, np.array([10.0, 200.0]))
    np.testing.assert_array_equal(whole.X - data.X, np.tile([10.0, 200.0, 10.0, 200.0], (3, 1)))
    np.testing.assert_array_equal(whole.tests[Measured.WITHIN].q.reshape(3, 4), whole.X)
    assert whole.tests[Measured.WITHIN].oracle is points.oracle


def test_lines_state_the_error_of_pixels_and_no_noise_that_nobody_chose() -> None:
    region = RegionFigures(
        measured="within", n=9, predicted=9, rmse_mm=0.3, oracle_mm=0.2, stated=9, covered=8, extrapolated=0
    )
    found = CaseFigures(
        trained=500, pixel_error_px=0.02, methods=(MethodFigures(method="dlt", regions=(region,)),)
    )
    simulated = Cell("brown", 0.6, 0.1, 60, Layout.PLANES)
    cases = [Case(cell, 0, ("dlt",), (Measured.WITHIN,), 50) for cell in (CELL, simulated)]
    table = results_table(lines_of(cases, [found, found.model_copy(update={"pixel_error_px": np.nan})]))
    lines = list(csv.DictReader(table.splitlines()))
    assert [line["source"] for line in lines] == ["rendered", "simulated"]
    assert [line["noise_px"] for line in lines] == ["nan", "0.1"]
    assert [line["pixel_error_px"] for line in lines] == ["0.02", "nan"]


def test_every_method_has_a_curve_and_what_has_none_its_reason(summary: Callable[..., CellSummary]) -> None:
    strong = Cell("brown", 1.0, 0.0, 520, Layout.PLANES, Source.RENDERED)
    blind = Cell("double-sphere", 1.0, 0.0, 520, Layout.PLANES, Source.RENDERED)
    summaries = [
        *(
            summary(method, (ratio,), cell=cell)
            for method, ratio in (("hybrid", 1.0), ("dlt", 30.0))
            for cell in (CELL, strong)
        ),
        summary("affine", (), cell=strong, reasons=("it refuses",)),
        *(summary(method, (), cell=blind, reasons=("it folds",)) for method in ("hybrid", "dlt")),
    ]
    drawn = rendered_figures(summaries)
    assert list(drawn) == ["rendered-brown.svg"]
    for word in ("hybrid", "dlt", "520 points, noise of the sensor"):
        assert word in drawn["rendered-brown.svg"]
    assert drawn == rendered_figures(summaries)
    assert rendered_notes(summaries) == [
        "brown 1, rendered, affine: it refuses",
        "double-sphere 1, rendered: it folds",
    ]


@pytest.mark.slow
def test_the_right_lens_is_near_the_oracle_through_pictures_and_a_linear_method_is_not() -> None:
    case = Case(CELL, 0, ("bundle", "dlt"), (Measured.WITHIN,), 500, pictures=Pictures(views=4, spp=32))
    found = measured_case(case)
    assert found.trained == 520
    assert 0.01 < found.pixel_error_px < 0.03
    bundle, dlt = found.methods
    right, wrong = bundle.regions[0], dlt.regions[0]
    assert right.n == right.predicted == 3 * 12 * 9
    assert right.over_oracle < 1.2
    assert abs(right.coverage95 - 0.95) < 4.0 * np.sqrt(0.95 * 0.05 / right.n)
    assert bundle.misfit is False
    assert wrong.over_oracle > 10.0
    assert dlt.misfit is True
