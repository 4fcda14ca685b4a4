from collections.abc import Callable
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
        ({"pitch_x_mm": 1e200}, "less than or equal to 1000000000"),
        ({"dot_diameter_mm": 1e-300}, "next to nothing"),
        ({"dot_diameter_mm": 1e-3}, "at least 0.02 mm wide"),
        ({"cols": 1000, "rows": 1000}, "at most 250000"),
        ({"margin_mm": 1e30}, "less than or equal to 1000000000"),
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


def shape(target: DotGrid) -> set[tuple[float, float]]:
    """Return the dots' places about the middle of all."""
    places = target.points()[:, :2]
    middle = (places.min(axis=0) + places.max(axis=0)) / 2
    return {(round(x, 6), round(y, 6)) for x, y in (places - middle).tolist()}


def without_rings(**changes: object) -> DotGrid:
    plain: dict[str, Any] = {"name": "plain", "rings": None, "pitch_x_mm": 20.0, "dot_diameter_mm": 8.0}
    return DotGrid.model_validate(plain | {"cols": 5, "rows": 4, "pitch_y_mm": 20.0} | changes)


def asymmetric(cols: int, rows: int) -> DotGrid:
    return without_rings(layout="asymmetric", cols=cols, rows=rows, pitch_y_mm=10.0)


def test_rows_with_an_odd_number_are_shifted_as_by_opencv() -> None:
    # cv2: the circle (j, i) of an asymmetric grid is at ((2 j + i % 2) s, i s).
    target = load_target("asymmetric-4x11")
    expected = [[(2 * j + i % 2) * 20.0, i * 20.0, 0.0] for i in range(11) for j in range(4)]
    assert np.array_equal(target.points(), expected)
    assert np.array_equal(target.points(np.array([[0, -1], [-1, 12]])), [[20.0, -20.0, 0], [-40.0, 240.0, 0]])
    assert target.extent_mm == (-20.0, -20.0, 160.0, 220.0)
    distances = np.linalg.norm(target.points()[:, None] - target.points()[None], axis=-1)
    assert np.sort(distances, axis=1)[:, 1] == pytest.approx(target.cell_mm[0])


@pytest.mark.parametrize("cols", [2, 3, 4, 5])
@pytest.mark.parametrize(
    ("make", "rows"),
    [(asymmetric, rows) for rows in (3, 4, 5, 8, 10)]
    + [(lambda cols, rows: without_rings(cols=cols, rows=rows), rows) for rows in (2, 3, 4, 5, 8, 10)],
)
def test_symmetric_indices_are_of_all_turns_after_which_a_grid_looks_the_same(
    make: Callable[[int, int], DotGrid], cols: int, rows: int
) -> None:
    target = make(cols, rows)
    places = shape(target)
    turns = [
        turn
        for turn in ([[0, -1], [1, 0]], [[-1, 0], [0, -1]], [[0, 1], [-1, 0]])
        if {
            (round(x, 6) + 0.0, round(y, 6) + 0.0)
            for x, y in (np.array(list(places)) @ np.array(turn).T).tolist()
        }
        == places
    ]
    found = target.symmetric_indices(target.indices())
    assert len(found) == len(turns)
    middle = (target.points().min(axis=0) + target.points().max(axis=0))[:2] / 2
    for index, turn in zip(found, turns, strict=True):
        moved = (target.points()[:, :2] - middle) @ np.array(turn).T + middle
        np.testing.assert_allclose(target.points(index)[:, :2], moved, atol=1e-9)


def test_with_rings_nothing_looks_the_same(grid: DotGrid) -> None:
    assert grid.symmetric_indices(grid.indices()) == ()
    assert grid.key_indices == grid.ring_indices
    assert len(without_rings().key_indices) == 20


def test_unequal_pitches_leave_half_a_turn() -> None:
    target = without_rings(cols=4, pitch_y_mm=21.0)
    (half,) = target.symmetric_indices(np.array([[0, 1], [-1, 5]]))
    assert np.array_equal(half, [[3, 2], [4, -2]])


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"layout": "asymmetric"}, "pitch_y_mm should be 10"),
        ({"layout": "asymmetric", "pitch_y_mm": 10.0, "dot_diameter_mm": 14.2}, "smaller than the pitch"),
        ({"ring_outer_diameter_mm": 8.0}, "mean nothing without rings"),
        ({"rings": {"origin": (0, 0), "x": (1, 0), "y": (0, 1)}}, "rings need ring_outer_diameter_mm"),
    ],
)
def test_grids_without_rings_are_checked(changes: dict[str, object], said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        without_rings(**changes)


def test_an_asymmetric_grid_has_no_rings(grid: DotGrid) -> None:
    with pytest.raises(ValidationError, match="set rings to null"):
        DotGrid.model_validate(grid.model_dump() | {"layout": "asymmetric", "pitch_y_mm": 10.0})


def test_rings_are_left_out_on_purpose_only(grid: DotGrid) -> None:
    content = grid.model_dump()
    del content["rings"]
    with pytest.raises(ValidationError, match="Field required"):
        DotGrid.model_validate(content)
