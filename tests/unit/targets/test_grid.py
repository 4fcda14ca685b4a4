from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from labcal.targets.catalogue import load_target
from labcal.targets.grid import DotGrid


def test_dots_run_row_by_row_from_the_lower_left(grid: DotGrid) -> None:
    points = grid.points()
    assert points.shape == (20, 3)
    assert np.array_equal(points[0], [0, 0, 0])
    assert np.array_equal(points[1], [20.0, 0, 0])  # (1, 0): x to the right
    assert np.array_equal(points[5], [0, 12.5, 0])  # (0, 1): y up
    assert np.array_equal(points[19], [80.0, 37.5, 0])
    assert np.array_equal(grid.indices()[7], [2, 1])


def test_dots_beyond_the_grid_have_places_too(grid: DotGrid) -> None:
    assert np.array_equal(grid.points(np.array([[-1, 6]])), [[-20.0, 75.0, 0.0]])


def test_rings_are_larger_where_they_say_so(grid: DotGrid) -> None:
    diameters = grid.outer_diameters_mm().reshape(grid.rows, grid.cols)
    assert {(col, row) for row, col in np.argwhere(diameters == 8.0).tolist()} == {(1, 0), (3, 0), (1, 2)}
    assert np.count_nonzero(diameters == 6.0) == 17


def test_the_extent_is_the_dots_and_the_margin(grid: DotGrid) -> None:
    assert grid.extent_mm == (-10.0, -10.0, 90.0, 47.5)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"rings": {"origin": (1, 0), "x": (3, 1), "y": (1, 2)}}, "row of the origin"),
        ({"rings": {"origin": (1, 0), "x": (0, 0), "y": (1, 2)}}, "further along x"),
        ({"rings": {"origin": (1, 0), "x": (3, 0), "y": (2, 2)}}, "column of the origin"),
        ({"rings": {"origin": (1, 2), "x": (3, 2), "y": (1, 0)}}, "further along y"),
        ({"rings": {"origin": (1, 0), "x": (5, 0), "y": (1, 2)}}, "outside the 5 x 4 grid"),
        ({"ring_inner_diameter_mm": 8.0}, "smaller than ring_outer_diameter_mm"),
        ({"dot_diameter_mm": 12.5}, "smaller than the pitch"),
        ({"ring_outer_diameter_mm": 13.0}, "smaller than the pitch"),
        ({"cols": 1}, "greater than or equal to 2"),
        ({"pitch_x_mm": float("inf")}, "finite number"),
        ({"name": "a_b"}, "match pattern"),
        ({"polarity": "grey"}, "black-on-white"),
    ],
)
def test_a_grid_that_cannot_be_is_refused(changes: dict[str, Any], said: str, grid: DotGrid) -> None:
    with pytest.raises(ValidationError, match=said):
        DotGrid.model_validate(grid.model_dump() | changes)


def test_the_shipped_targets_are_those_of_the_specification() -> None:
    paper = load_target("paper-13x10")
    spread = np.ptp(paper.points(), axis=0)
    assert spread == pytest.approx([700.0, 700.0, 0.0], abs=1e-9)  # 0.7 m x 0.7 m
    assert paper.count == 130
    for name, count, pitch, origin, x, y in (
        ("rings-10x8", 80, 3.5, (2, 2), (7, 2), (2, 5)),
        ("rings-14x10", 140, 7.0, (2, 2), (11, 2), (2, 7)),
    ):
        target = load_target(name)
        assert (target.count, target.pitch_x_mm, target.pitch_y_mm) == (count, pitch, pitch)
        assert target.ring_indices == (origin, x, y)
