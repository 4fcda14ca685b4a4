from itertools import combinations

import numpy as np
import pytest
from edited import edited
from scipy.spatial.transform import Rotation

from labcal.correspond.points import Points
from labcal.errors import InputError
from labcal.evaluate.own_lengths import errors_of_lengths
from labcal.targets.grid import DotGrid
from labcal.targets.places import DotPlaces


def views(grid: DotGrid, scale: float) -> Points:
    """Return three views of the target at arbitrary places, larger by `scale`."""
    index = grid.indices()
    parts = []
    for number in range(3):
        R = Rotation.from_rotvec([0.3 * number, -0.5, 1.0]).as_matrix()
        parts.append(scale * grid.points() @ R.T + [100.0 * number, -50, 900])
    n = 3 * grid.count
    return Points(
        view=np.repeat(["a", "b", "c"], grid.count),
        index=np.tile(index, (3, 1)),
        point=np.concatenate(parts),
        covariance=np.full((n, 3, 3), np.nan),
        flag=np.full(n, "ok"),
    )


@pytest.mark.parametrize("ppm", [0.0, 250.0, -1000.0])
def test_a_scaled_copy_has_that_scale(grid: DotGrid, ppm: float) -> None:
    found = errors_of_lengths(views(grid, 1 + 1e-6 * ppm), grid)
    lengths = [np.linalg.norm(a - b) for a, b in combinations(grid.points(), 2)]
    assert found.n == 3 * len(lengths)
    assert found.scale_ppm == pytest.approx(ppm, abs=1e-6)
    assert found.length_error_mm.max == pytest.approx(1e-6 * abs(ppm) * max(lengths), abs=1e-9)
    rms = np.sqrt(np.mean(np.square(lengths)))
    assert found.length_error_mm.rms == pytest.approx(1e-6 * abs(ppm) * rms, abs=1e-9)
    assert np.isnan(found.epipolar_rms_px)


def test_one_wrong_dot_shows_in_the_greatest_error(grid: DotGrid) -> None:
    points = views(grid, 1.0)
    first, last = points.point[0], points.point[grid.count - 1]
    points = edited(points, "point", 0, first + (first - last) * 0.1)
    diagonal = np.linalg.norm(grid.points()[0] - grid.points()[-1])
    found = errors_of_lengths(points, grid)
    assert found.length_error_mm.max == pytest.approx(0.1 * diagonal)
    assert found.length_error_mm.rms < found.length_error_mm.max / 3


def test_missing_points_are_left_out(grid: DotGrid) -> None:
    points = views(grid, 1.0)
    points = edited(points, "point", slice(None, grid.count), np.nan)
    assert errors_of_lengths(points, grid).n == 2 * grid.count * (grid.count - 1) // 2
    one_a_view = points.where(points.index.sum(axis=1) == 0)
    with pytest.raises(InputError, match="no two points of the same view"):
        errors_of_lengths(one_a_view, grid)


def test_lengths_of_a_misprinted_target_are_those_of_its_freed_dots(grid: DotGrid) -> None:
    n = grid.count
    places = grid.points() + np.random.default_rng(0).normal(0, 0.02, (n, 3))
    points = views(grid, 1.0)
    R = Rotation.from_rotvec([0.1, 0.7, -0.2]).as_matrix()
    points = edited(points, "point", slice(None, n), places @ R.T + 30.0)
    points = edited(points, "point", slice(n, None), np.nan)
    freed = DotPlaces.of(grid, places, np.zeros((n, 3, 3)), np.full(n, 9), np.full(n, fill_value=True))
    assert errors_of_lengths(points, grid).length_error_mm.rms > 0.02
    assert errors_of_lengths(points, freed).length_error_mm.max < 1e-9


def test_lengths_from_dots_that_were_not_freed_do_not_count(grid: DotGrid) -> None:
    points = views(grid, 1.0)
    column = points.index[:, 0] == 0
    points = edited(points, "point", column, points.point[column] + np.array([0.0, 0.0, 5.0]))
    freed = grid.indices()[:, 0] > 0
    nothing = np.zeros((grid.count, 3, 3))
    places = DotPlaces.of(grid, grid.points(), nothing, np.full(grid.count, 3), freed)
    found = errors_of_lengths(points, places)
    assert found.n == 3 * freed.sum() * (freed.sum() - 1) // 2
    assert found.length_error_mm.max == pytest.approx(0.0, abs=1e-9)


def test_dots_of_another_target_are_refused(grid: DotGrid) -> None:
    points = views(grid, 1.0)
    points = edited(points, "index", 4, (grid.cols, 0))
    with pytest.raises(InputError, match=rf"dot \({grid.cols}, 0\)"):
        errors_of_lengths(points, grid)
