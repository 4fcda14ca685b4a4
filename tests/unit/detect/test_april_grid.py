"""Corners of AprilGrids in drawn pictures: ids, places, covariances, boards in part, refusals."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from scipy.stats import chi2

from labcal.bench.boards.april_grid_ink import april_grid_ink
from labcal.bench.boards.april_grid_picture import AprilGridPicture
from labcal.bench.boards.corner_bound import ImagedTagCorner, corner_bounds
from labcal.bench.marks.drawn_picture import INK, PAPER, Cover, Exposure, drawn, tilted
from labcal.detect.corners.corners import Corners
from labcal.detect.corners.picture_corners import picture_corners, refused_as_few
from labcal.detect.detector import detect_dots
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag, Refusal
from labcal.detect.settings import DetectSettings
from labcal.targets.april_grid import AprilGrid

SIZE = (220, 160)
GRID = AprilGrid(kind="aprilgrid", name="small", tag_cols=3, tag_rows=2, tag_mm=10.0, tag_spacing=0.3)


def exposure(*, tilt: float = 0.4, roll: float = 0.3, tag: float = 34.0, blur: float = 1.0) -> Exposure:
    """Return a camera above the middle of the grid, with uneven light."""
    H = tilted(tilt, 0.7, roll, 500.0 * GRID.tag_mm / tag, 500.0)
    x, y = GRID.points()[:, :2].mean(axis=0)
    H = H @ np.array([[1.0, 0.0, -x], [0.0, 1.0, -y], [0.0, 0.0, 1.0]])
    H = np.array([[1.0, 0.0, 109.3], [0.0, 1.0, 79.8], [0.0, 0.0, 1.0]]) @ H
    return Exposure(SIZE, H, blur, np.array([0.002, 0.001]), 0.01)


def picture(
    how: Exposure, seed: int = 0, covers: tuple[Cover, ...] = (), grid: AprilGrid = GRID
) -> np.ndarray:
    return drawn(how, april_grid_ink(grid), covers, np.random.default_rng(seed))


def errors(dots: PictureDots, how: Exposure) -> np.ndarray:
    """Return measured minus true places of the ok corners, px."""
    return dots.position[dots.ok] - how.seen(GRID.points(dots.index[dots.ok])[:, :2])


@pytest.mark.parametrize("roll", [0.3, 1.8, -2.6])
def test_the_grid_is_numbered_however_it_is_turned(roll: float) -> None:
    how = exposure(roll=roll)
    dots = detect_dots(picture(how), GRID)
    assert dots.refusal is None
    assert np.array_equal(dots.index, GRID.indices())
    assert np.abs(errors(dots, how)).max() < 0.1


def test_normalised_errors_pass_a_chi_square_test_and_are_half_of_opencvs() -> None:
    squares, count, ours, theirs = 0.0, 0, 0.0, 0.0
    for seed, tilt in enumerate((0.1, 0.5, 0.9)):
        how = exposure(tilt=tilt)
        seen = picture(how, seed)
        dots = detect_dots(seen, GRID)
        off = errors(dots, how)
        squares += float(np.einsum("ni,nij,nj->", off, np.linalg.inv(dots.covariance[dots.ok]), off))
        count += 2 * len(off)
        # OpenCV begins at our corners, which is kinder than its own rough ones.
        begin = dots.position[dots.ok].astype(np.float32).reshape(-1, 1, 2).copy()
        ends = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 30, 0.01)
        refined = cv2.cornerSubPix(seen, begin, (3, 3), (-1, -1), ends).reshape(-1, 2)
        true = how.seen(GRID.points(dots.index[dots.ok])[:, :2])
        ours, theirs = ours + float((off**2).sum()), theirs + float(((refined - true) ** 2).sum())
    assert count > 5 * GRID.count
    assert 0.005 < chi2.sf(squares, count) < 0.995
    assert np.sqrt(ours) < 0.5 * np.sqrt(theirs)


def test_a_tone_curve_moves_no_corner() -> None:
    inward, squares, count = [], 0.0, 0
    for seed, roll in enumerate((0.0, 0.7, 1.3, 2.1)):
        how = exposure(roll=roll)
        light = picture(how, seed) / 255.0
        srgb = np.where(light > 0.0031308, 1.055 * light ** (1.0 / 2.4) - 0.055, 12.92 * light)
        dots = detect_dots(np.rint(255.0 * srgb).astype(np.uint8), GRID)
        off, index = errors(dots, how), dots.index[dots.ok]
        into = how.seen(GRID.points(index + 1 - 2 * (index % 2))[:, :2]) - how.seen(GRID.points(index)[:, :2])
        inward.append((off * into).sum(axis=1) / np.linalg.norm(into, axis=1))
        squares += float(np.einsum("ni,nij,nj->", off, np.linalg.inv(dots.covariance[dots.ok]), off))
        count += 2 * len(off)
    every = np.concatenate(inward)
    assert count > 7 * GRID.count
    assert abs(every.mean()) < 3.3 * every.std() / np.sqrt(len(every))
    assert 0.5 < squares / count < 1.3


def test_a_part_of_the_grid_numbers_itself_and_what_is_hidden_is_not_measured() -> None:
    how = exposure()
    how = replace(how, H=np.array([[1.0, 0, 40], [0, 1, 15], [0, 0, 1]]) @ how.H)
    cover = Cover(np.array([160.0, 110.0]), np.array([22.0, 14.0]), 0.4, 0.5)
    dots = detect_dots(picture(how, covers=(cover,)), GRID)
    assert dots.refusal is None
    assert np.abs(errors(dots, how)).max() < 0.15
    true = how.seen(GRID.points()[:, :2])
    clear = (
        (true > 8.0).all(axis=1) & (true < np.array(SIZE) - 9.0).all(axis=1) & (cover.distance(true) > 12.0)
    )
    found = {(int(i), int(j)) for i, j in dots.index[dots.ok]}
    assert {(int(i), int(j)) for i, j in GRID.indices()[clear]} - found == set()
    hidden = {(int(i), int(j)) for i, j in GRID.indices()[cover.distance(true) < 0.0]}
    assert hidden
    assert not hidden & found


def test_another_grid_is_refused_by_name() -> None:
    seen = picture(exposure())
    dots = detect_dots(seen, GRID.model_copy(update={"first_id": 100}))
    assert dots.refusal is Refusal.OTHER_IDS
    assert "Tags 0 to 5 of DICT_APRILTAG_36h11 were read; the target has 100 to 105." in dots.detail
    assert (
        detect_dots(seen, GRID.model_copy(update={"tag_cols": 2, "tag_rows": 3})).refusal
        is Refusal.OTHER_BOARD
    )
    assert detect_dots(seen, GRID.model_copy(update={"border_cells": 1})).refusal is not None
    assert detect_dots(np.full((160, 220), 90, dtype=np.uint8), GRID).refusal is Refusal.NO_MARKERS


def test_borders_of_one_cell_are_read_too() -> None:
    one = GRID.model_copy(update={"border_cells": 1, "tag_spacing": 0.25})
    dots = detect_dots(picture(exposure(), grid=one), one)
    assert dots.refusal is None
    assert dots.ok.sum() == one.count


@pytest.mark.parametrize(("border", "spacing"), [(2, 0.3), (1, 0.25), (1, 0.5)])
def test_tags_without_squares_at_their_corners_are_measured(border: int, spacing: float) -> None:
    bare = GRID.model_copy(
        update={"corner_squares": False, "border_cells": border, "tag_spacing": spacing, "first_id": 9}
    )
    squares, count = 0.0, 0
    for seed, (tilt, roll) in enumerate(((0.1, 0.3), (0.5, 1.8), (0.8, -2.6))):
        how = exposure(tilt=tilt, roll=roll)
        dots = detect_dots(picture(how, seed, grid=bare), bare)
        assert dots.refusal is None
        off = dots.position[dots.ok] - how.seen(bare.points(dots.index[dots.ok])[:, :2])
        assert len(off) > 0.8 * bare.count
        assert np.abs(off).max() < 0.2
        squares += float(np.einsum("ni,nij,nj->", off, np.linalg.inv(dots.covariance[dots.ok]), off))
        count += 2 * len(off)
    # Light of white cells in a border of one cell: stated errors are up to a tenth too small.
    assert chi2.cdf(squares / (1.0 if border > 1 else 1.2), count) < 0.999


def test_squares_at_corners_that_are_not_as_the_target_has_them_are_told() -> None:
    bare, how = GRID.model_copy(update={"corner_squares": False}), exposure()
    dots = detect_dots(picture(how, grid=bare), GRID)
    assert dots.refusal is Refusal.CORNER_SQUARES
    assert "no small black squares touch their corners" in dots.why
    dots = detect_dots(picture(how), bare)
    assert dots.refusal is Refusal.CORNER_SQUARES
    assert "which the target says are not printed" in dots.why
    nothing = np.full((160, 220), 90, dtype=np.uint8)
    assert detect_dots(nothing, bare).refusal is Refusal.NO_MARKERS


def test_errors_are_near_the_bound() -> None:
    squares, bounds = 0.0, 0.0
    for seed, tilt in enumerate((0.1, 0.6)):
        how = exposure(tilt=tilt)
        shown = AprilGridPicture(
            picture(how, seed), GRID, how, how.seen(GRID.points()[:, :2]), np.ones(GRID.count, dtype=bool)
        )
        dots = detect_dots(shown.picture, GRID)
        for off, (col, row) in zip(errors(dots, how), dots.index[dots.ok], strict=True):
            number = int(row * GRID.cols + col)
            light = float(how.light(shown.corner[number]))
            corner = ImagedTagCorner(shown.corner[number], shown.axes(number), 1.0,
                                     INK * light, PAPER * light, gap=0.3, border=0.2)  # fmt: skip
            noise = 0.01 * np.sqrt(0.5 * light * (INK + PAPER))
            bounds += float(np.trace(corner_bounds(corner, np.array([[noise, noise]]))[0]))
            squares += float((off**2).sum())
    assert np.sqrt(squares / bounds) < 1.2


def test_small_cells_that_are_blurred_are_read() -> None:
    for seed, roll in enumerate((0.1, 0.9, -2.0)):
        how = exposure(tilt=0.3, roll=roll, tag=17.0, blur=0.8)
        dots = detect_dots(picture(how, seed), GRID)
        assert dots.refusal is None
        assert dots.ok.sum() == GRID.count
        assert np.abs(errors(dots, how)).max() < 0.15


def test_edges_along_the_rows_without_any_blur_are_measured() -> None:
    # Every tag runs otherwise between the pixels.
    H = np.array([[4.03, 0.0, 40.2], [0.0, -4.03, 130.4], [0.0, 0.0, 1.0]])
    how = Exposure(SIZE, H, 0.02, np.zeros(2), 0.001)
    dots = detect_dots(picture(how), GRID)
    assert dots.refusal is None
    assert dots.ok.sum() == GRID.count
    assert np.abs(errors(dots, how)).max() < 0.15


@pytest.mark.parametrize("turn", [0.0, 0.3])
def test_thresholded_pictures_state_what_hard_edges_leave(turn: float) -> None:
    squares, count = 0.0, 0
    for shift in (0.0, 0.3, 0.6, 0.9):
        c, s = 4.03 * np.cos(turn), 4.03 * np.sin(turn)
        how = Exposure(
            SIZE,
            np.array([[c, s, 45.2 + shift], [s, -c, 125.1 + shift], [0.0, 0.0, 1.0]]),
            0.02,
            np.zeros(2),
            0.001,
        )
        dots = detect_dots(np.where(picture(how) > 110, 220, 30).astype(np.uint8), GRID)
        off = errors(dots, how)
        assert len(off) > 0.7 * GRID.count
        squares += float(np.einsum("ni,nij,nj->", off, np.linalg.inv(dots.covariance[dots.ok]), off))
        count += 2 * len(off)
    # Corners of one grid share where their edges run between pixels: this is no chi-square.
    assert squares / count < 1.5


def test_torn_corners_are_told_from_too_few_by_their_own_flags() -> None:
    # Tags 0 and 1, tag by tag as they are found; only the lower row of corners is clear of the frame.
    index = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [2, 0], [3, 0], [3, 1], [2, 1]])
    places = np.array([20.0, 100.0]) + [30.0, -99.0] * index
    grey = np.zeros((160, 220), dtype=np.float32)
    few = Corners(index, places, [None] * len(index))
    dots = picture_corners(few, grey, None, DetectSettings())
    assert [flag is DotFlag.CUT for flag in dots.flag] == [False] * 4 + [True] * 4
    assert refused_as_few(dots, few.index, "").refusal is Refusal.TOO_FEW_DOTS
    torn = Corners(index, places + np.array([0.0, 40.0]), [None] * len(index))
    dots = picture_corners(torn, grey, None, DetectSettings())
    assert refused_as_few(dots, torn.index, "").refusal is Refusal.TORN_CORNERS


def test_a_first_id_that_is_a_row_off_is_told() -> None:
    tall = AprilGrid(kind="aprilgrid", name="tall", tag_cols=3, tag_rows=3, tag_mm=10.0, tag_spacing=0.3)
    print_ = tall.model_copy(update={"first_id": 6})
    grey = picture(exposure(tag=26.0), grid=print_)
    for first in (3, 9):
        dots = detect_dots(grey, tall.model_copy(update={"first_id": first}))
        assert dots.refusal is Refusal.OTHER_IDS
        assert "They fit the grid with first_id: 6." in dots.detail
    assert detect_dots(grey, print_).refusal is None
    shorter = tall.model_copy(update={"first_id": 6, "tag_rows": 2})  # a print may have more rows
    assert detect_dots(grey, shorter).refusal is None
