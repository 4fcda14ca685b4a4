from collections.abc import Callable
from dataclasses import fields, replace

import numpy as np
import pytest
from edited import edited

from labcal.cameras.camera import Camera
from labcal.correspond.detections import Detections
from labcal.correspond.matching import match, require_on_target, rows_by_name, stage_points
from labcal.errors import InputError
from labcal.targets.grid import DotGrid


@pytest.fixture
def exact(
    see: Callable[..., Detections], pair: dict[str, Camera], grid: DotGrid, poses: dict[str, np.ndarray]
) -> Detections:
    return see(pair, grid, poses)


def test_columns_follow_the_cameras_and_lines_the_dots(exact: Detections, grid: DotGrid) -> None:
    order = np.random.default_rng(1).permutation(len(exact))
    mixed = Detections(*(getattr(exact, field.name)[order] for field in fields(exact)))
    found = match(mixed, ("right", "left"))
    assert len(found) == 8 * grid.count
    assert found.X.shape == (8 * grid.count, 4)
    assert list(dict.fromkeys(found.view)) == list(mixed.views)
    for view in mixed.views:
        of_view = found.where(found.view == view)
        np.testing.assert_array_equal(of_view.index, grid.indices())
        for column, camera in ((0, "right"), (1, "left")):
            picture = exact.where((exact.view == view) & (exact.camera == camera))
            np.testing.assert_array_equal(of_view.q[:, column], picture.position)
            np.testing.assert_array_equal(of_view.X[:, 2 * column : 2 * column + 2], picture.position)


def test_a_dot_that_one_camera_lost_is_no_match(exact: Detections, grid: DotGrid) -> None:
    flag = exact.flag.copy()
    flag[(exact.camera == "left") & (exact.index[:, 0] == 3)] = "bad-fit"
    found = match(replace(exact, flag=flag), ("left", "right"))
    assert len(found) == 8 * grid.rows * (grid.cols - 1)
    assert 3 not in found.index[:, 0]
    assert len(match(replace(exact, flag=flag), ("right",))) == 8 * grid.count


def test_nothing_in_common_is_an_empty_table(exact: Detections) -> None:
    found = match(exact.where((exact.camera == "left") == (exact.view == "pose-0")), ("left", "right"))
    assert found.X.shape == (0, 4)
    assert found.covariance.shape == (0, 2, 2, 2)


def test_a_missing_camera_is_named(exact: Detections) -> None:
    with pytest.raises(InputError, match="no detections of camera middle, only of left, right"):
        match(exact, ("left", "middle"))


def test_stage_points_are_the_dots_at_their_poses(
    exact: Detections, grid: DotGrid, poses: dict[str, np.ndarray]
) -> None:
    matches = match(exact, ("left", "right"))
    known = {view: T for view, T in poses.items() if view != "pose-2"}
    p = stage_points(matches, grid, known)
    assert np.isnan(p[matches.view == "pose-2"]).all()
    for view, T in known.items():
        homogeneous = np.hstack([grid.points(), np.ones((grid.count, 1))])
        np.testing.assert_allclose(p[matches.view == view], (homogeneous @ T.T)[:, :3], atol=1e-9)


@pytest.mark.parametrize("index", [(5, 0), (0, 4), (-1, 0)])
def test_an_ok_dot_beyond_the_target_tells_of_another_target(
    exact: Detections, grid: DotGrid, index: tuple[int, int]
) -> None:
    require_on_target(exact, grid)
    exact = edited(exact, "index", 17, index)
    with pytest.raises(InputError, match=r"but the target 'small' has 5 x 4 dots"):
        require_on_target(exact, grid)
    exact = edited(exact, "flag", 17, "beyond-grid")
    require_on_target(exact, grid)


def test_rows_by_name_keep_the_order_of_appearance() -> None:
    found = rows_by_name(np.array(["b", "a", "b", "c", "a"]))
    assert list(found) == ["b", "a", "c"]
    assert [rows.tolist() for rows in found.values()] == [[0, 2], [1, 4], [3]]
    assert rows_by_name(np.empty(0, dtype=np.str_)) == {}
