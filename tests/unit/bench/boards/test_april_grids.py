"""Drawn pictures of AprilGrids and the bound of their corners."""

import numpy as np
import pytest

from labcal.bench.boards.april_grid_ink import april_grid_ink
from labcal.bench.boards.april_grid_picture import KALIBR, AprilGridPicture, april_grid_picture
from labcal.bench.boards.board_checks import board_checks, time_check
from labcal.bench.boards.board_outcome import BoardOutcome
from labcal.bench.boards.corner_bound import ImagedTagCorner, corner_bounds
from labcal.bench.marks.drawn_picture import Exposure
from labcal.targets.april_grid_outlines import tag_cells


def test_the_print_has_cells_squares_and_linear_edges() -> None:
    ink, cell = april_grid_ink(KALIBR), KALIBR.tag_mm / 10
    # Rows of samples go down: y falls. The second tag of the first row, its cells.
    at = (np.arange(10) + 0.5) * cell
    x, y = np.meshgrid(1.3 * KALIBR.tag_mm + at, at[::-1])
    assert np.array_equal(ink(x, y) > 0.5, tag_cells(KALIBR)[1])
    # A small square's corner touches the tag's; beside it the paper is white.
    fine = np.linspace(-0.3 * cell, 0.3 * cell, 7)
    x, y = np.meshgrid(fine, fine[::-1])
    value = ink(x, y)
    assert value[0, -1] == value[-1, 0] == 1.0
    assert value[0, 0] == value[-1, -1] == 0.0
    assert value[3, 3] == pytest.approx(0.5)


def test_axes_lead_into_the_tag() -> None:
    H = np.array([[100.0, 0.0, 50.0], [0.0, -100.0, 300.0], [0.0, 0.0, 1.0]])
    exposure = Exposure((480, 360), H, 0.5, np.zeros(2), 0.01)
    corner = exposure.seen(KALIBR.points()[:, :2])
    picture = AprilGridPicture(
        np.zeros((0, 0), np.uint8), KALIBR, exposure, corner, np.ones(len(corner), bool)
    )
    for number, expected in (
        (0, [[100, 0], [0, -100]]),
        (1, [[-100, 0], [0, -100]]),
        (11, [[-100, 0], [0, 100]]),
    ):
        assert np.allclose(picture.axes(number), expected)
    assert picture.gap_px(0) == pytest.approx(30.0)


def test_the_bound_of_a_tags_corner_grows_as_the_border_narrows() -> None:
    axes = np.array([[40.0, 6.0], [-4.0, 38.0]])
    noises = np.array([[2.0, 2.0]])
    wide, narrow = (
        corner_bounds(
            ImagedTagCorner(np.array([70.3, 80.6]), axes, 0.8, 20.0, 200.0, gap=gap, border=border), noises
        )
        for gap, border in ((0.3, 0.2), (0.25, 0.03))
    )
    assert (np.linalg.eigvalsh(narrow - wide) > 0).all()
    assert 0.001 < np.sqrt(wide[0, 0, 0]) < 0.05


def test_pictures_are_the_same_again_and_half_in_sight() -> None:
    picture = april_grid_picture(1, 3)
    assert picture.countable
    assert picture.picture.shape == (360, 480)
    assert picture.visible.mean() >= 0.5
    assert np.array_equal(picture.picture, april_grid_picture(1, 3).picture)


def test_a_way_of_opencv_that_finds_nothing_has_no_ratio() -> None:
    random = np.random.default_rng(0)
    error, eye = random.standard_normal((40, 2)), np.tile(np.eye(2), (40, 1, 1))
    outcome = BoardOutcome(
        indexed=True, wrong=0, missed=0, error=error, covariance=eye, bound=eye, second_bound=eye,
        opencv={"one": 3.0 * error, "other": np.zeros((0, 2))},
        own={"one": error, "other": np.zeros((0, 2))},
        seconds={"labcal": 0.1, "one": 0.1, "other": 0.1},
    )  # fmt: skip
    found = [*board_checks("x", [outcome], "another fit").checks, time_check("x", "one", [outcome], 2.0)]
    checks = {one.name: one for one in found}
    assert all(one.ok for one in checks.values())
    assert "x: RMS error over that of one" in checks
    assert "x: RMS error over that of other" not in checks
