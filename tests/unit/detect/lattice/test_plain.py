"""Grids whose dots are all alike: every id right up to the target's own symmetry, or a refusal."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest

from labcal.detect.detector import detect_dots
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag, Refusal
from labcal.detect.lattice.plain import turn_in_picture
from labcal.targets.catalogue import load_target
from labcal.targets.grid import DotGrid

PLAIN, ASYMMETRIC = load_target("plain-11x8"), load_target("asymmetric-4x11")
EVEN = ASYMMETRIC.model_copy(update={"cols": 5, "rows": 8})
SQUARE = PLAIN.model_copy(update={"cols": 7, "rows": 7})
WHOLE = {"focal": 330.0, "distance": 420.0, "size": (320, 320), "noise": 1.0}
MakeBoard = Callable[..., Any]


def as_bytes(picture: np.ndarray) -> np.ndarray:
    return np.clip(np.round(picture), 0, 255).astype(np.uint8)


def worst(board: Any, dots: PictureDots, index: np.ndarray) -> float:  # noqa: ANN401 - a class of conftest.py
    """Return the largest distance of an ok dot from where OpenCV projects its outline's centroid, px."""
    pairs = zip(index[dots.ok].tolist(), dots.position[dots.ok], strict=True)
    return float(max(np.abs(q - board.centroid(tuple(key))).max() for key, q in pairs))


@pytest.mark.parametrize(
    ("target", "numberings", "rotation"),
    [
        (PLAIN, 2, (20, -15, 8)),
        (PLAIN, 2, (-40, 20, 100)),
        (SQUARE, 4, (-40, 20, 100)),
        (ASYMMETRIC, 1, (-40, 20, 100)),
        (EVEN, 2, (20, -15, 190)),
    ],
    ids=["plain", "plain-turned", "square", "asymmetric", "even"],
)
def test_one_of_the_numberings_is_the_true_one(
    target: DotGrid, numberings: int, rotation: tuple[float, float, float], make_board: MakeBoard
) -> None:
    board = make_board(target, rotation=rotation, **WHOLE)
    dots = detect_dots(as_bytes(board.draw()), target)
    assert dots.refusal is None
    assert int(dots.ok.sum()) == target.count
    assert len(dots.others) == numberings - 1
    errors = [worst(board, dots, index) for index in (dots.index, *dots.others)]
    assert sorted(error < 0.06 for error in errors) == [False] * (numberings - 1) + [True]
    # A way up that only a turn tells is taken as nearly upright as it goes.
    turn = turn_in_picture(target.points(dots.index)[:, :2], dots.position)
    assert numberings == 1 or abs(np.degrees(turn)) < 180 / numberings + 15


def test_the_other_way_up_is_told_by_an_odd_number_of_shifted_rows(make_board: MakeBoard) -> None:
    board = make_board(ASYMMETRIC, rotation=(0, 0, 180), **WHOLE)
    dots = detect_dots(as_bytes(board.draw()), ASYMMETRIC)
    assert worst(board, dots, dots.index) < 0.06
    assert dots.others == ()


@pytest.mark.parametrize("target", [PLAIN, ASYMMETRIC])
def test_a_part_of_the_grid_is_refused(target: DotGrid, make_board: MakeBoard) -> None:
    cut = make_board(target, aim=(0.35, 0.3), **WHOLE | {"distance": 250.0})
    row = make_board(target, missing=frozenset((col, 0) for col in range(target.cols)), **WHOLE)
    for board in (cut, row):
        dots = detect_dots(as_bytes(board.draw()), target)
        assert dots.refusal is Refusal.AMBIGUOUS
        assert not dots.has_id.any()
        assert len(dots.flag) > target.count / 2
        assert set(dots.flag) == {DotFlag.NO_ID}


def test_a_larger_print_is_refused(make_board: MakeBoard) -> None:
    larger = make_board(PLAIN, extra=1, **WHOLE | {"distance": 560.0})
    assert detect_dots(as_bytes(larger.draw()), PLAIN).refusal is Refusal.AMBIGUOUS
    # Of a larger print just as many rows as declared are whole; the cut ones beside them tell.
    close = make_board(PLAIN, extra=1, focal=400.0, distance=420.0, size=(224, 166), noise=1.0)
    assert detect_dots(as_bytes(close.draw()), PLAIN).refusal is Refusal.AMBIGUOUS


def test_hidden_dots_within_the_grid_leave_the_others_their_ids(make_board: MakeBoard) -> None:
    missing = frozenset({(0, 0), (5, 3), (6, 3), (2, 7), (10, 4)})
    board = make_board(PLAIN, rotation=(25, 10, -20), missing=missing, **WHOLE)
    dots = detect_dots(as_bytes(board.draw()), PLAIN)
    assert dots.refusal is None
    assert int(dots.ok.sum()) == PLAIN.count - len(missing)
    assert worst(board, dots, dots.index) < 0.06


def test_two_equal_boards_are_refused(make_board: MakeBoard) -> None:
    board = make_board(PLAIN, **WHOLE | {"distance": 500.0})
    picture = np.concatenate([board.draw(), replace(board, seed=2).draw()], axis=1)
    assert detect_dots(as_bytes(picture), PLAIN).refusal is Refusal.SEVERAL_TARGETS


def test_pitches_that_nearly_agree_leave_a_quarter_turn_open(make_board: MakeBoard) -> None:
    # Both numberings fit the columns and rows, but the target is not symmetric under the turn between them.
    target = SQUARE.model_copy(update={"pitch_x_mm": 21.0})
    board = make_board(target, **WHOLE)
    assert detect_dots(as_bytes(board.draw()), target).refusal is Refusal.AMBIGUOUS


def test_barrel_distortion_does_not_matter(make_board: MakeBoard) -> None:
    board = make_board(ASYMMETRIC, rotation=(30, 20, 70), distortion=(-0.3, 0.0), **WHOLE)
    dots = detect_dots(as_bytes(board.draw()), ASYMMETRIC)
    assert int(dots.ok.sum()) == ASYMMETRIC.count
    assert worst(board, dots, dots.index) < 0.1


def test_opencv_finds_the_dots_in_the_same_places() -> None:
    """OpenCV's asymmetric grid of the same size, drawn by its own formula, gets the places it says."""
    places = np.array([[(2 * j + i % 2) * 20.0, i * 20.0] for i in range(11) for j in range(4)])
    picture = np.full((520, 400), 200, np.uint8)
    shift = 4  # bits of the fixed-point coordinates
    for x, y in places * 2.0 + 60.0:
        centre = (round(x * 2**shift), round(y * 2**shift))
        cv2.circle(picture, centre, 12 * 2**shift, 10, -1, cv2.LINE_AA, shift)
    picture = cv2.GaussianBlur(picture, (0, 0), 0.7)
    found, centres = cv2.findCirclesGrid(picture, (4, 11), flags=cv2.CALIB_CB_ASYMMETRIC_GRID)
    assert found
    dots = detect_dots(picture, ASYMMETRIC)
    assert dots.refusal is None
    # Eleven rows are shifted alike counted from either end; OpenCV counts them downward.
    ours = {tuple(key): q for key, q in zip(dots.index.tolist(), dots.position, strict=True)}
    for k, q in enumerate(centres.reshape(-1, 2)):
        np.testing.assert_allclose(ours[k % 4, 10 - k // 4], q, atol=0.5)
    drawn = ASYMMETRIC.points(dots.index)[:, :2] * [2.0, -2.0] + [60.0, 60.0 + 400.0]
    np.testing.assert_allclose(dots.position, drawn, atol=0.1)


@pytest.mark.parametrize("cols", [3, 6, 9])
def test_asymmetric_grids_with_three_rows_are_found(cols: int) -> None:
    """No dot of theirs has a dot two rows above and below, as the crosses of other grids have."""
    target = DotGrid(
        name="flat", layout="asymmetric", cols=cols, rows=3, pitch_x_mm=20, pitch_y_mm=10, dot_diameter_mm=6,
        rings=None, margin_mm=20,
    )  # fmt: skip
    fine, size, turned = 4, (640, 260), np.array([[0.96, -0.2], [0.16, 0.93]])
    canvas = np.full((size[1] * fine, size[0] * fine), 215, dtype=np.uint8)
    index = target.indices()
    places = target.points(index)[:, :2] * [2.4, -2.4] @ turned.T + [60.0, 120.0]
    for x, y in np.round(((places + 0.5) * fine - 0.5) * 16).astype(int):
        cv2.circle(canvas, (int(x), int(y)), int(7.2 * fine * 16), 35, -1, cv2.LINE_AA, 4)
    picture = cv2.GaussianBlur(cv2.resize(canvas, size, interpolation=cv2.INTER_AREA), (0, 0), 0.7)
    picture = picture + np.random.default_rng(8).normal(0, 1.0, picture.shape)
    dots = detect_dots(np.clip(picture, 0, 255).astype(np.uint8), target)
    assert dots.refusal is None
    np.testing.assert_array_equal(dots.index[dots.ok], index)
    assert np.abs(dots.position[dots.ok] - places).max() < 0.1


def test_asymmetric_grids_with_two_rows_are_refused_when_they_are_made() -> None:
    with pytest.raises(ValueError, match="of 2 rows is not found in pictures: give it 3 rows or more"):
        DotGrid(
            name="flat", layout="asymmetric", cols=9, rows=2, pitch_x_mm=20, pitch_y_mm=10, rings=None,
            dot_diameter_mm=6, margin_mm=20,
        )  # fmt: skip
