import numpy as np
import pytest

from labcal.scene.board import Bend, Board
from labcal.scene.surface import FACET_ERROR_MM, Surface
from labcal.targets.catalogue import load_target
from labcal.targets.grid import DotGrid
from labcal.targets.print_scale import printed_to_scale
from labcal.targets.sheet import lay_out_with_code

BENDS = {
    "bowl": Bend(along_x_mm=4.0, along_y_mm=2.0),
    "dome": Bend(along_x_mm=-4.0, along_y_mm=-1.0),
    "saddle": Bend(along_x_mm=3.0, along_y_mm=-2.0, twist_mm=1.0),
    "twist": Bend(twist_mm=-3.0),
    "twisted bowl": Bend(along_x_mm=4.0, along_y_mm=2.0, twist_mm=3.0),
}


def over_the_board(surface: Surface, n: int) -> np.ndarray:
    """Return places on the board on a lattice that holds its corners, shape (n * n, 2)."""
    steps = np.linspace(-1.0, 1.0, n)
    return surface.middle + surface.half * np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)


def test_heights_at_edges_and_corners_are_as_given(grid: DotGrid) -> None:
    surface = Surface.of(grid, Bend(along_x_mm=4.0, along_y_mm=2.0, twist_mm=0.5))
    x_min, y_min, x_max, y_max = grid.extent_mm
    x, y = 0.5 * (x_min + x_max), 0.5 * (y_min + y_max)
    places = np.array([[x, y], [x_max, y], [x_min, y], [x, y_max], [x_max, y_max], [x_min, y_max]])
    points = surface.points(places)
    np.testing.assert_array_equal(points[:, :2], places)
    np.testing.assert_allclose(points[:, 2], [0.0, 4.0, 4.0, 2.0, 6.5, 5.5], atol=1e-12)


@pytest.mark.parametrize("name", BENDS)
def test_normals_and_the_lowest_height_are_those_of_differences(grid: DotGrid, name: str) -> None:
    surface = Surface.of(grid, BENDS[name])
    places = over_the_board(surface, 401)
    assert surface.lowest_mm() == pytest.approx(surface.points(places)[:, 2].min(), abs=1e-3)
    step = 1e-4
    along_x, along_y = (
        surface.points(places + step * np.array(way)) - surface.points(places - step * np.array(way))
        for way in ([1.0, 0.0], [0.0, 1.0])
    )
    normal = np.cross(along_x, along_y)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    np.testing.assert_allclose(surface.normals(places), normal, atol=1e-7)


@pytest.mark.parametrize("name", BENDS)
def test_facets_are_as_near_as_promised(grid: DotGrid, name: str) -> None:
    surface = Surface.of(grid, BENDS[name])
    n = surface.cells()
    assert n < 200
    corner = surface.middle - surface.half
    cell = 2.0 * surface.half / n
    a, b = np.meshgrid(np.linspace(0.0, 1.0, 21), np.linspace(0.0, 1.0, 21))
    for at in ([0, 0], [n // 3, n // 2], [n - 1, n - 1]):
        p00, p10, p11, p01 = (
            surface.points(corner + cell * (np.array(at) + step)) for step in ([0, 0], [1, 0], [1, 1], [0, 1])
        )
        lower = p00 + a[..., None] * (p10 - p00) + b[..., None] * (p11 - p10)
        upper = p00 + a[..., None] * (p11 - p01) + b[..., None] * (p01 - p00)
        facets = np.where((a >= b)[..., None], lower, upper)
        error = facets[..., 2] - surface.points(facets[..., :2])[..., 2]
        assert np.abs(error).max() <= FACET_ERROR_MM * 1.000001


def test_a_flat_board_hides_itself_only_from_behind(grid: DotGrid) -> None:
    surface = Surface.of(grid, Bend())
    places = over_the_board(surface, 5)
    above, below = np.array([[10.0, 20.0, 5.0]]), np.array([[10.0, 20.0, -5.0]])
    assert not surface.hides(above, places).any()
    assert surface.hides(below, places).all()
    assert surface.cells() == 1


@pytest.mark.parametrize("name", BENDS)
def test_a_bent_board_hides_what_paths_reach_through_it(grid: DotGrid, name: str) -> None:
    surface = Surface.of(grid, BENDS[name])
    places = over_the_board(surface, 6)
    end, share = surface.points(places), np.linspace(0.0, 1.0, 20001)[1:, None, None]
    some = 0
    for eye in ([-70.0, -30.0, 6.0], [150.0, 20.0, 9.0], [40.0, 150.0, 12.0], [40.0, 19.0, 300.0]):
        path = end + share * (np.array(eye) - end)
        height = path[..., 2] - surface.points(path[..., :2])[..., 2]
        on_board = (np.abs(path[..., :2] - surface.middle) <= surface.half + 1e-9).all(axis=-1)
        through = (on_board & (height < -1e-9)).any(axis=0)
        hidden = surface.hides(np.array([eye]), places)
        np.testing.assert_array_equal(hidden, through | (height[0] < 0.0))
        some += int(hidden.sum())
    assert some > 0


def test_a_numbered_print_is_as_large_as_its_sheet_at_its_scale() -> None:
    target = load_target("rings-10x8")
    cut = lay_out_with_code(target).cut
    bare = Surface.of_board(target, Board())
    whole = Surface.of_board(printed_to_scale(target, (0.98, 1.02)), Board(print_number=0))
    np.testing.assert_allclose(bare.half, Surface.of(target, Bend()).half)
    np.testing.assert_allclose(2.0 * whole.half, np.array([cut.width, cut.height]) * [0.98, 1.02])
    assert whole.half[1] > bare.half[1]
