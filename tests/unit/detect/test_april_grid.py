"""Corners of AprilGrids in drawn pictures: ids, places, covariances, boards in part, refusals."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from scipy.stats import chi2

from labcal.bench.boards.april_grid_ink import april_grid_ink
from labcal.bench.marks.drawn_picture import Cover, Exposure, drawn, tilted
from labcal.detect.detector import detect_dots
from labcal.detect.dots import PictureDots
from labcal.detect.flags import Refusal
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
