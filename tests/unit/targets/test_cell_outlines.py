"""Outlines of black cells, and of all that is printed: an edge has ink on one side only."""

import itertools

import numpy as np
import pytest

from labcal import load_target
from labcal.targets.april_grid import AprilGrid
from labcal.targets.cell_outlines import cell_outlines
from labcal.targets.charuco import CharucoBoard
from labcal.targets.polygons import as_polygons, print_polygons
from labcal.targets.print_code import print_code
from labcal.targets.target import PrintableTarget

BOARDS = {
    "charuco": CharucoBoard.model_validate(
        {
            "kind": "charuco",
            "name": "c",
            "squares": (5, 4),
            "square_mm": 20.0,
            "marker_mm": 15.0,
            "dictionary": "DICT_5X5_100",
        }
    ),
    "tags": AprilGrid(kind="aprilgrid", name="a", tag_cols=2, tag_rows=2, tag_mm=10.0, tag_spacing=0.3),
    "tags without squares": AprilGrid(
        kind="aprilgrid",
        name="b",
        tag_cols=2,
        tag_rows=2,
        tag_mm=10.0,
        tag_spacing=0.3,
        border_cells=1,
        corner_squares=False,
    ),
    "chessboard": load_target("chessboard-marked-13x8"),
}


def area(polygon: np.ndarray) -> float:
    x, y = polygon.T
    return 0.5 * float((x[:-1] * y[1:] - x[1:] * y[:-1]).sum())


def is_ink(polygons: list[np.ndarray], places: np.ndarray) -> np.ndarray:
    """Return whether outlines run around places (n, 2), by the sides that a ray to the right crosses."""
    turns, (x, y) = np.zeros(len(places), dtype=int), places.T
    for polygon in polygons:
        for (x0, y0), (x1, y1) in itertools.pairwise(polygon.tolist()):
            crossed = (min(y0, y1) <= y) & (y < max(y0, y1))
            right = x < x0 + (y - y0) * (x1 - x0) / (y1 - y0 or 1.0)
            turns += np.sign(y1 - y0).astype(int) * (crossed & right)
    return np.asarray(turns != 0)


def require_edges(polygons: list[np.ndarray], aside: float) -> None:
    sides = np.concatenate([np.stack([one[:-1], one[1:]], axis=1) for one in polygons])
    way = sides[:, 1] - sides[:, 0]
    normal = np.stack([-way[:, 1], way[:, 0]], axis=1) / np.hypot(*way.T)[:, None]
    for share in (0.05, 0.5, 0.95):
        at = sides[:, 0] + share * way
        assert is_ink(polygons, at + aside * normal).all()
        assert not is_ink(polygons, at - aside * normal).any()


@pytest.mark.parametrize("seed", range(20))
def test_outlines_are_as_long_and_as_large_as_the_cells(seed: int) -> None:
    random = np.random.default_rng(seed)
    cells = random.random(random.integers(1, 9, 2)) < random.choice([0.3, 0.5, 0.8])
    polygons = as_polygons(cell_outlines(cells))
    sides = np.pad(cells, 1).astype(int)
    assert sum(map(area, polygons)) == pytest.approx(cells.sum())
    assert sum(np.abs(np.diff(one, axis=0)).sum() for one in polygons) == pytest.approx(
        np.abs(np.diff(sides, axis=0)).sum() + np.abs(np.diff(sides, axis=1)).sum()
    )
    row, col = np.indices(cells.shape)
    middles = np.stack([col + 0.5, cells.shape[0] - row - 0.5], axis=-1).reshape(-1, 2)
    np.testing.assert_array_equal(is_ink(polygons, middles), cells.ravel())


@pytest.mark.parametrize("board", BOARDS.values(), ids=BOARDS)
def test_a_printed_edge_has_ink_on_one_side_only(board: PrintableTarget) -> None:
    require_edges(print_polygons(board), 1e-3)


def test_a_code_has_no_edges_within_its_ink() -> None:
    require_edges(as_polygons(print_code("LABCAL:1").outlines(3.0, 7.0, 2.0)), 1e-3)
