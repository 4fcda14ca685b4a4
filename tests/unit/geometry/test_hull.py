import numpy as np
import pytest
from scipy.spatial import Delaunay
from scipy.spatial.transform import Rotation

from labcal.geometry.hull import inside_hull

TURN = Rotation.from_rotvec([0.3, -0.8, 0.5]).as_matrix()
SHIFT = np.array([900.0, -300.0, 1700.0])


def placed(p: list[list[float]] | np.ndarray) -> np.ndarray:
    """Return points somewhere in space, so that no axis is special."""
    return np.asarray(p, dtype=float) @ TURN.T + SHIFT


def test_a_cloud_agrees_with_its_triangulation() -> None:
    rng = np.random.default_rng(1)
    cloud, asked = rng.normal(size=(60, 3)) * 100, rng.normal(size=(2000, 3)) * 120
    expected = Delaunay(cloud).find_simplex(asked) >= 0
    assert 100 < expected.sum() < 1900
    np.testing.assert_array_equal(inside_hull(asked, cloud, 1e-9), expected)


def test_a_plane_has_a_hull_in_its_plane() -> None:
    square = placed([[0, 0, 0], [100, 0, 0], [100, 100, 0], [0, 100, 0], [50, 50, 0]])
    asked = placed(
        [[50, 20, 0], [0, 0, 0], [100, 40, 0], [100.1, 40, 0], [50, 50, 0.1], [50, 50, 1e-4], [-5, 50, 0]]
    )
    expected = [True, True, True, False, False, True, False]
    np.testing.assert_array_equal(inside_hull(asked, square, 1e-3), expected)


def test_a_line_has_a_hull_on_its_line() -> None:
    line = placed([[0, 0, 0], [40, 0, 0], [100, 0, 0]])
    asked = placed([[50, 0, 0], [100, 0, 0], [101, 0, 0], [50, 1, 0], [-1, 0, 0]])
    np.testing.assert_array_equal(inside_hull(asked, line, 1e-3), [True, True, False, False, False])


@pytest.mark.parametrize("copies", [1, 2, 5])
def test_a_single_place_holds_itself_alone(copies: int) -> None:
    place = np.repeat(placed([[3, 4, 5]]), copies, axis=0)
    asked = placed([[3, 4, 5], [3, 4, 5.1]])
    np.testing.assert_array_equal(inside_hull(asked, place, 1e-3), [True, False])


def test_nothing_is_inside_of_nothing_and_nan_is_inside_nowhere() -> None:
    cube = placed(np.stack(np.meshgrid([0, 9], [0, 9], [0, 9]), axis=-1).reshape(-1, 3))
    asked = np.stack([placed([[4, 4, 4]])[0], np.full(3, np.nan)])
    assert not inside_hull(asked, np.zeros((0, 3)), 1.0).any()
    np.testing.assert_array_equal(inside_hull(asked, cube, 1e-3), [True, False])
    np.testing.assert_array_equal(
        inside_hull(asked, cube[cube[:, 0] == cube[0, 0]][:1], 1e-3), [False, False]
    )
