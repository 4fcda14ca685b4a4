"""The choice of a lens for dots that reach the rim of a fisheye's round picture."""

import pytest

from labcal.bench.distortion.case import Case, Cell, Layout
from labcal.bench.distortion.cell_data import cell_data
from labcal.bench.families.cameras import SIZE
from labcal.calibrate.resection.lens_choice import chosen_camera


@pytest.mark.slow
def test_a_lens_that_ends_short_of_the_corners_of_the_box_around_the_dots_is_no_worse() -> None:
    """The fisheye's polynomial is exact for all dots, and folds in corners where none of them is."""
    data = cell_data(Case(Cell("double-sphere", 1.0, 0.1, 320, Layout.PLANES), 0, (), (), 0))
    found = chosen_camera("test", data.X[:, 2:], data.Y, SIZE)
    low, high = data.X[:, 2:].min(axis=0), data.X[:, 2:].max(axis=0)
    corners = [[u, v] for u in (low[0], high[0]) for v in (low[1], high[1])]
    assert not found.camera.rays(corners).ok.all()  # else this would test nothing
    assert found.camera.lens == "fisheye-kb4"
    assert found.sigma_px < 0.11
