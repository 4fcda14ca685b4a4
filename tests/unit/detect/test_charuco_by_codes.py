"""ChArUco boards whose markers are too blurred, too worn or too far from each other to be read one by one."""

import cv2
import numpy as np
import pytest

from labcal.bench.boards.charuco_ink import charuco_ink
from labcal.bench.boards.charuco_picture import charuco_picture
from labcal.bench.marks.drawn_picture import Exposure, drawn
from labcal.detect.corners.board_by_codes import corners_by_codes
from labcal.detect.corners.code_likeness import CodeLikeness, board_codes, turned_codes
from labcal.detect.detector import detect_dots
from labcal.detect.flags import Refusal
from labcal.detect.lattice.rings import TURNS
from labcal.detect.settings import DetectSettings
from labcal.targets.charuco import CharucoBoard, MarkerDictionary
from labcal.targets.charuco_opencv import markers, opencv_board

BOARD = CharucoBoard(
    kind="charuco", name="by-codes", squares=(7, 5), square_mm=1.0, marker_mm=0.75,
    dictionary=MarkerDictionary.DICT_5X5_100,
)  # fmt: skip


def view(turn_deg: float, blur: float, noise: float = 0.02) -> Exposure:
    """Return a view of the board from its front, its squares 26 px wide."""
    turn = np.radians(turn_deg)
    R = 26.0 * np.array([[np.cos(turn), np.sin(turn)], [np.sin(turn), -np.cos(turn)]])
    H = np.eye(3)
    H[:2, :2] = R
    H[:2, 2] = np.array([130.0, 120.0]) - R @ BOARD.points()[:, :2].mean(axis=0)
    H[2, :2] = [1e-3, -2e-3]
    return Exposure((260, 240), H, blur, np.array([2e-3, -1e-3]), noise)


def with_worn_codes(picture: np.ndarray, exposure: Exposure, kept: set[int]) -> np.ndarray:
    """Return a picture whose codes are rubbed to an even grey, but for some."""
    for number, corner in enumerate(markers(BOARD).corner):
        if number not in kept:
            inner = corner + 0.75 * np.array([[0.13, 0.13], [0.87, 0.13], [0.87, 0.87], [0.13, 0.87]])
            cv2.fillConvexPoly(picture, np.round(exposure.seen(inner)).astype(np.int32), 60, cv2.LINE_AA)
    return picture


@pytest.mark.parametrize("turn_deg", [10.0, 100.0, 190.0, -75.0])
def test_a_board_none_of_whose_markers_opencv_reads_is_placed(turn_deg: float) -> None:
    exposure = view(turn_deg, 2.1)
    picture = drawn(exposure, charuco_ink(BOARD), (), np.random.default_rng(1))
    read = cv2.aruco.CharucoDetector(opencv_board(BOARD)).detectBoard(picture)
    assert read[3] is None or len(read[3]) < 2
    dots = detect_dots(picture, BOARD)
    assert dots.refusal is None
    off = dots.position[dots.ok] - exposure.seen(BOARD.points(dots.index[dots.ok])[:, :2])
    assert len(dots.index) == BOARD.count  # all are placed; some are too blurred to be measured
    assert np.abs(off).max() < 0.4


def test_corners_are_neighbours_though_blurred_codes_have_more_saddle_points_between_them() -> None:
    view = charuco_picture(67, 616)
    dots = detect_dots(view.picture, view.board)
    assert dots.refusal is None
    off = dots.position[dots.ok] - view.corner[dots.index[dots.ok] @ [1, view.board.cols]]
    assert dots.ok.sum() >= 0.9 * view.visible.sum()
    assert np.abs(off).max() < 0.3


def test_corners_beside_a_small_lattice_are_looked_for_where_its_codes_are_not_enough() -> None:
    """Fifteen saddle points between them hold two whole squares: likely (4.8 deviations), but not certain."""
    view = charuco_picture(86, 616)
    picture = drawn(view.exposure, charuco_ink(view.board), view.covers, np.random.default_rng(3))
    found = corners_by_codes(picture.astype(np.float32), view.board, DetectSettings())
    assert len(found.index) >= 25
    off = found.seen_at - view.corner[found.index @ [1, view.board.cols]]
    assert np.abs(off).max() < 1.0


def test_two_clear_codes_far_from_each_other_place_a_board_by_its_lattice() -> None:
    exposure = view(30.0, 0.7)
    picture = with_worn_codes(
        drawn(exposure, charuco_ink(BOARD), (), np.random.default_rng(2)), exposure, {7, 9}
    )
    assert len(corners_by_codes(picture.astype(np.float32) / 255.0, BOARD, DetectSettings()).index) > 8
    dots = detect_dots(picture, BOARD)
    assert dots.refusal is None
    off = dots.position[dots.ok] - exposure.seen(BOARD.points(dots.index[dots.ok])[:, :2])
    assert np.abs(off).max() < 0.2


def test_two_markers_of_the_rim_are_refused_with_what_would_be_needed() -> None:
    exposure = view(30.0, 0.7)
    picture = with_worn_codes(
        drawn(exposure, charuco_ink(BOARD), (), np.random.default_rng(2)), exposure, {0, 16}
    )
    dots = detect_dots(picture, BOARD)
    assert dots.refusal is Refusal.MARKERS_UNREADABLE
    assert "too far from each other" in dots.detail


def test_a_board_with_more_columns_is_not_placed_by_the_rows_that_agree() -> None:
    picture = charuco_picture(6, 11)  # the lines by which one would see that the board has ended are hidden
    grey = picture.picture.astype(np.float32) / 255.0
    columns, rows = picture.board.squares
    other = picture.board.model_copy(update={"squares": (columns + 1, rows)})
    assert len(corners_by_codes(grey, picture.board, DetectSettings()).index) > 0
    assert len(corners_by_codes(grey, other, DetectSettings()).index) == 0


@pytest.mark.parametrize("number", [113, 139])
def test_saddle_points_of_white_strips_do_not_hide_the_lattice_of_a_blurred_board(number: int) -> None:
    picture = charuco_picture(number, 12)  # strips beside the squares are as wide as the blur, markers unread
    dots = detect_dots(picture.picture, picture.board)
    assert dots.refusal is None
    off = dots.position[dots.ok] - picture.corner[dots.index[dots.ok] @ [1, picture.board.cols]]
    assert dots.ok.sum() > 20
    assert np.abs(off).max() < 0.3


def test_boards_with_other_codes_or_in_a_mirror_are_not_placed() -> None:
    exposure = view(10.0, 2.1)
    picture = drawn(exposure, charuco_ink(BOARD), (), np.random.default_rng(3))
    for wrong in (
        BOARD.model_copy(update={"first_id": 40}),
        BOARD.model_copy(update={"dictionary": MarkerDictionary.DICT_6X6_50}),
        BOARD.model_copy(update={"squares": (5, 5)}),
    ):
        dots = detect_dots(picture, wrong)
        assert dots.refusal is not None
    mirrored = detect_dots(np.ascontiguousarray(picture[:, ::-1]), BOARD)
    assert mirrored.refusal in (Refusal.NO_MARKERS, Refusal.MARKERS_UNREADABLE)


def test_likeness_to_wrong_codes_is_standard_normal() -> None:
    random = np.random.default_rng(5)
    codes = board_codes(BOARD)
    blurred = np.stack([cv2.GaussianBlur(code, (0, 0), 0.6) for code in codes])
    likeness = CodeLikeness.of(0.5 * blurred + random.normal(0, 0.05, codes.shape), BOARD.dictionary)
    every = np.arange(len(codes))
    assert likeness.sigmas(every, codes).min() > 2.5
    other = board_codes(BOARD.model_copy(update={"first_id": 50}))
    wrong = np.concatenate(
        [
            likeness.sigmas(every, turned_codes(other[random.permutation(len(other))], turn))
            for turn in range(4)
        ]
        + [likeness.sigmas(every, np.roll(turned_codes(codes, turn), 1 + turn, axis=0)) for turn in range(4)]
    )
    assert abs(wrong.mean()) < 4.0 / np.sqrt(len(wrong))
    assert 0.75 < wrong.std() < 1.25


def test_codes_turn_as_the_lattice_does() -> None:
    code = board_codes(BOARD)[:1]
    for turn, matrix in enumerate(TURNS):
        seen = turned_codes(code, turn)[0]
        for x, y in [(0, 0), (1, 3), (4, 2)]:
            i, j = np.rint(matrix @ (np.array([x, y]) - 2) + 2).astype(int)
            assert seen[x, y] == code[0, i, j]
