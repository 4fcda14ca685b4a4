"""Statuses one by one: the smallest pictures that should get each, and what their words say."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from labcal.bench.boards.april_grid_ink import april_grid_ink
from labcal.bench.boards.charuco_ink import charuco_ink
from labcal.bench.boards.chessboard_picture import MARKED, _ink
from labcal.bench.boards.chessboard_picture import PLAIN as CHESSBOARD
from labcal.bench.marks.drawn_picture import Exposure, Print, drawn, tilted
from labcal.detect.detector import detect_dots
from labcal.detect.flags import Refusal
from labcal.targets.april_grid import AprilGrid
from labcal.targets.charuco import CharucoBoard, MarkerDictionary
from labcal.targets.grid import DotGrid, Rings
from labcal.targets.target import Target

MakeBoard = Callable[..., Any]
SIZE = (300, 240)
CHARUCO = CharucoBoard(
    kind="charuco", name="charuco", squares=(6, 5), square_mm=1.0, marker_mm=0.75,
    dictionary=MarkerDictionary.DICT_4X4_50,
)  # fmt: skip
APRIL = AprilGrid(kind="aprilgrid", name="april", tag_cols=3, tag_rows=3, tag_mm=1.0, tag_spacing=0.3)
RINGS = DotGrid(
    name="rings", cols=7, rows=5, pitch_x_mm=20, pitch_y_mm=20, dot_diameter_mm=10, margin_mm=20,
    ring_outer_diameter_mm=10, ring_inner_diameter_mm=5, rings=Rings(origin=(1, 1), x=(4, 1), y=(1, 3)),
)  # fmt: skip
PLAIN_DOTS = DotGrid(
    name="plain", cols=7, rows=5, pitch_x_mm=20, pitch_y_mm=20, dot_diameter_mm=10, margin_mm=20, rings=None
)


def shown(
    target: Target, ink: Print, step_px: float, blur: float = 0.7, noise: float = 0.008, mirror: float = 1.0
) -> np.ndarray:
    """Draw a board of unit squares in the middle of a picture, a step of so many px."""
    H = np.diag([mirror, 1.0, 1.0]) @ tilted(0.3, 0.6, 0.15, 700.0 / step_px, 700.0)
    x_min, y_min, x_max, y_max = target.extent_mm
    middle = H @ [(x_min + x_max) / 2, (y_min + y_max) / 2, 1.0]
    to_middle = np.array([SIZE[0], SIZE[1]]) / 2 - middle[:2] / middle[2]
    H = np.array([[1.0, 0, to_middle[0]], [0, 1.0, to_middle[1]], [0, 0, 1.0]]) @ H
    return drawn(Exposure(SIZE, H, blur, np.zeros(2), noise), ink, (), np.random.default_rng(3))


def dots_drawn(make_board: MakeBoard, target: DotGrid, **how: Any) -> np.ndarray:  # noqa: ANN401 -- of a class of conftest.py
    board = make_board(target, size=SIZE, focal=400.0, rotation=(15, -10, 6), noise=1.0, **how)
    return np.clip(np.round(board.draw()), 0, 255).astype(np.uint8)


def test_dots_that_are_too_small_are_not_told_to_be_too_few(make_board: MakeBoard) -> None:
    rings = detect_dots(dots_drawn(make_board, RINGS, distance=1150.0), RINGS)
    assert rings.refusal is Refusal.TOO_SMALL
    assert "The holes of its rings are some 1." in rings.why
    plain = detect_dots(dots_drawn(make_board, PLAIN_DOTS, distance=1800.0), PLAIN_DOTS)
    assert plain.refusal is Refusal.TOO_SMALL
    assert plain.why.startswith("A grid of dots some 2.")
    assert detect_dots(dots_drawn(make_board, RINGS, distance=400.0), RINGS).indexed


def test_too_few_dots_are_counted(make_board: MakeBoard) -> None:
    picture = dots_drawn(make_board, PLAIN_DOTS, distance=110.0, aim=(0.16, 0.2))
    dots = detect_dots(picture, PLAIN_DOTS)
    assert dots.refusal is Refusal.TOO_FEW_DOTS
    assert dots.why.startswith("6 round spots were seen whole; a grid takes 9. Too few dots")


def test_a_grid_without_its_rings_is_described(make_board: MakeBoard) -> None:
    other = DotGrid.model_validate(
        {**RINGS.model_dump(), "rings": {"origin": (1, 1), "x": (5, 1), "y": (1, 3)}}
    )
    dots = detect_dots(dots_drawn(make_board, RINGS, distance=300.0), other)
    assert dots.refusal is Refusal.NO_RINGS
    assert dots.why.startswith("7 columns and 5 rows of dots were seen between x = ")
    assert "the target has 7 and 5. 3 rings were seen among them." in dots.why


def test_a_board_in_part_says_which_lines_are_seen() -> None:
    picture = shown(CHESSBOARD, _ink(CHESSBOARD), 24.0)
    dots = detect_dots(np.ascontiguousarray(picture[:, 120:]), CHESSBOARD)
    assert dots.refusal is Refusal.BOARD_IN_PART
    assert "columns and 6 rows of corners were seen between x = " in dots.why
    assert "; the target has 9 and 6." in dots.why


def test_a_chessboard_of_more_corners_is_described() -> None:
    dots = detect_dots(
        shown(CHESSBOARD, _ink(CHESSBOARD), 24.0), CHESSBOARD.model_copy(update={"cols": 7, "rows": 5})
    )
    assert dots.refusal is Refusal.OTHER_CHESSBOARD
    assert dots.why.startswith("9 columns and 6 rows of corners were seen")


def test_squares_that_are_too_small_are_not_told_to_be_out_of_the_frame() -> None:
    dots = detect_dots(shown(CHESSBOARD, _ink(CHESSBOARD), 5.5), CHESSBOARD)
    assert dots.refusal is Refusal.TOO_SMALL
    assert "A square is some 5." in dots.why


def test_a_drawn_chessboard_is_measured_or_told_to_have_hard_edges() -> None:
    picture = shown(CHESSBOARD, _ink(CHESSBOARD), 24.0, blur=0.3, noise=0.0)
    hard = np.where(picture > 110, 230, 20).astype(np.uint8)
    dots = detect_dots(hard, CHESSBOARD)
    if dots.refusal is None:
        assert np.sqrt(np.trace(dots.covariance[dots.ok], axis1=1, axis2=2).min()) > 0.02
    else:
        assert dots.refusal is Refusal.TORN_CORNERS
        assert "no blur" in dots.why


@pytest.mark.parametrize("part", [slice(None), slice(60, None)])
def test_marks_that_are_not_the_boards_are_not_passed_over(part: slice) -> None:
    ink = _ink(MARKED)
    itself = detect_dots(np.ascontiguousarray(shown(MARKED, ink, 18.0)[:, part]), MARKED)
    assert itself.refusal is None
    mirrored = detect_dots(np.ascontiguousarray(shown(MARKED, ink, 18.0, mirror=-1.0)[:, part]), MARKED)
    assert mirrored.refusal is Refusal.MIRRORED
    other = MARKED.model_copy(update={"marks": ((3, 4), (4, 4), (3, 5))})
    assert detect_dots(shown(MARKED, ink, 18.0), other).refusal is Refusal.OTHER_CHESSBOARD


@pytest.mark.parametrize(("target", "ink"), [(CHARUCO, charuco_ink), (APRIL, april_grid_ink)])
def test_markers_in_a_mirror_are_told(target: Any, ink: Callable[..., Print]) -> None:  # noqa: ANN401 -- two kinds
    assert detect_dots(shown(target, ink(target), 36.0), target).refusal is None
    assert detect_dots(shown(target, ink(target), 36.0, mirror=-1.0), target).refusal is Refusal.MIRRORED


def test_tags_whose_cells_are_too_small_or_blurred_are_told_so() -> None:
    small = detect_dots(shown(APRIL, april_grid_ink(APRIL), 12.0), APRIL)
    assert small.refusal in (Refusal.TOO_SMALL, Refusal.NO_MARKERS)
    blurred = detect_dots(shown(APRIL, april_grid_ink(APRIL), 48.0, blur=4.9), APRIL)
    assert blurred.refusal in (Refusal.BLURRED, Refusal.NO_MARKERS, Refusal.MARKERS_UNREADABLE)


def test_codes_that_are_blurred_beyond_reading_are_told_so() -> None:
    dots = detect_dots(shown(CHARUCO, charuco_ink(CHARUCO), 38.0, blur=6.0), CHARUCO)
    assert dots.refusal in (Refusal.BLURRED, Refusal.NO_MARKERS)
    assert not dots.ok.any()


def test_a_burnt_board_is_told_from_one_that_is_not_there() -> None:
    picture = shown(APRIL, april_grid_ink(APRIL), 36.0, noise=0.0).astype(np.float64)
    burnt = np.clip(248.0 + (picture - picture.min()) * 0.6, 0, 255)
    burnt += np.random.default_rng(1).normal(0, 2.0, burnt.shape)
    dots = detect_dots(np.clip(np.round(burnt), 0, 255).astype(np.uint8), APRIL)
    assert dots.refusal is Refusal.SATURATED
    paper = np.full((240, 300), 255, dtype=np.uint8)
    cv2.rectangle(paper, (100, 100), (140, 150), 0, -1)
    assert detect_dots(paper, APRIL).refusal is Refusal.NO_MARKERS  # white paper is no fault


def test_hardly_measured_dots_are_counted_by_their_flags(make_board: MakeBoard) -> None:
    picture = dots_drawn(make_board, RINGS, distance=300.0).astype(np.float64)
    burnt = np.clip(245.0 + picture * 0.5, 0, 255).astype(np.uint8)
    dots = detect_dots(burnt, RINGS)
    assert dots.refusal in (Refusal.NO_USABLE_DOTS, Refusal.SATURATED)
    if dots.refusal is Refusal.NO_USABLE_DOTS:
        assert "measured; not measured: " in dots.why


def test_the_guide_has_a_row_for_every_refusal() -> None:
    guide = Path(__file__).parents[3] / "docs" / "how-to" / "read-flags-and-refusals.md"
    rows = [line for line in guide.read_text(encoding="utf-8").splitlines() if line.startswith("| `")]
    assert [one.value for one in Refusal if not any(f"`{one.value}`" in row for row in rows)] == []
