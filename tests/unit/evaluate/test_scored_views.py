from dataclasses import replace

import numpy as np
import pytest

from labcal.correspond.points import Points
from labcal.evaluate.own_lengths import LengthErrors, errors_of_lengths
from labcal.evaluate.scored_views import ScoredViews, scored_description
from labcal.targets.grid import DotGrid
from labcal.targets.places import DotPlaces

VIEWS = ("a", "b", "c")


@pytest.fixture
def points(grid: DotGrid) -> Points:
    """Of three views, the first of which is 1% too large."""
    n, size = grid.count, np.repeat([1.01, 1.0, 1.0], grid.count)
    return Points(
        view=np.repeat(VIEWS, n),
        index=np.tile(grid.indices().astype(np.int64), (3, 1)),
        point=np.tile(grid.points(), (3, 1)) * size[:, None],
        covariance=np.full((3 * n, 3, 3), np.nan),
        flag=np.full(3 * n, "ok", dtype="<U16"),
    )


def told(points: Points, grid: DotGrid, learned: tuple[str, ...]) -> LengthErrors:
    nothing = np.zeros(grid.count, dtype=int)
    covariance = np.zeros((grid.count, 3, 3))
    places = DotPlaces.of(grid, grid.points(), covariance, nothing, np.ones(grid.count, dtype=bool))
    return errors_of_lengths(points, places.model_copy(update={"calibrated_on": learned}))


def test_views_that_were_calibrated_from_are_not_scored(points: Points, grid: DotGrid) -> None:
    errors = told(points, grid, ("a", "elsewhere"))
    assert errors.views_scored == ("b", "c")
    assert errors.views_calibrated_on == 0
    assert errors.length_error_mm.max < 1e-9
    assert errors.warnings == ()
    assert "2 views held out" in scored_description(2, 0)


def test_where_there_are_no_others_the_figures_are_said_to_be_circular(points: Points, grid: DotGrid) -> None:
    errors = told(points, grid, VIEWS)
    assert errors.views_scored == VIEWS
    assert errors.views_calibrated_on == 3
    assert "circular" in errors.warnings[0]
    assert "circular" in scored_description(3, 3)


def test_not_knowing_is_said(points: Points, grid: DotGrid) -> None:
    errors = errors_of_lengths(points, grid)
    assert errors.views_calibrated_on is None
    assert "not known" in scored_description(3, None)
    assert ScoredViews.of(points.view, None).holds(points.view).all()
    spoilt = replace(points, flag=np.full(len(points), "model-misfit"))
    assert errors_of_lengths(spoilt, grid).n_ok == 0
    assert "none of the scored points" in errors_of_lengths(spoilt, grid).warnings[0]
