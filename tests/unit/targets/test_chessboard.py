"""The description of a chessboard: symmetries, marks, print."""

import numpy as np
import pytest
from pydantic import ValidationError

from labcal.targets.catalogue import load_target
from labcal.targets.chessboard import Chessboard
from labcal.targets.chessboard_outlines import chessboard_outlines
from labcal.targets.code_text import code_text, described_by
from labcal.targets.ink_distance import ink_distance


def board(cols: int, rows: int, **given: object) -> Chessboard:
    return Chessboard.model_validate(
        {"kind": "chessboard", "name": "one", "cols": cols, "rows": rows, "square_mm": 10.0, **given}
    )


@pytest.mark.parametrize(
    ("cols", "rows", "turns"),
    [(9, 6, (0,)), (8, 6, (0, 2)), (7, 5, (0, 2)), (6, 6, (0, 1, 2, 3)), (5, 5, (0, 2))],
)
def test_colours_and_numbers_of_corners_tell_the_symmetries(
    cols: int, rows: int, turns: tuple[int, ...]
) -> None:
    assert board(cols, rows).symmetric_turns() == turns
    # The same by the colours of all squares, turned as a picture is.
    i, j = np.meshgrid(np.arange(cols + 1), np.arange(rows + 1), indexing="ij")
    black = board(cols, rows).is_black(i, j)
    found = [
        k for k in range(4) if np.rot90(black, k).shape == black.shape and (np.rot90(black, k) == black).all()
    ]
    assert tuple(found) == turns


def test_marks_must_number_the_corners_and_lie_among_them() -> None:
    with pytest.raises(ValidationError, match="no inner corner"):
        board(9, 6, marks=[[0, 3]])
    with pytest.raises(ValidationError, match="looks the same after a turn"):
        board(8, 6, marks=[[4, 3]])
    assert board(8, 6, marks=[[3, 3]]).symmetric_indices(np.zeros((1, 2), dtype=np.int64)) == ()


@pytest.mark.parametrize(("cols", "rows"), [(2, 5), (9, 2)])
def test_a_board_that_no_picture_shows_is_refused(cols: int, rows: int) -> None:
    with pytest.raises(ValidationError, match="greater than or equal to 3"):
        board(cols, rows)


def test_the_print_is_black_where_squares_are_and_scaled_as_it_is() -> None:
    one = board(3, 3, marks=[[1, 1], [2, 1]], print_scale=(1.01, 0.99))
    outlines = chessboard_outlines(one)
    low, high = outlines.vertices.min(axis=0), outlines.vertices.max(axis=0)
    np.testing.assert_allclose(low, [-10.1, -9.9])
    np.testing.assert_allclose(high, [30.3, 29.7])
    ink = ink_distance(one)

    def is_inked(x: float, y: float) -> bool:
        col = round((x - ink.origin[0]) / ink.step_mm)
        row = round((y - ink.origin[1]) / ink.step_mm)
        return bool(ink.distance[row, col] > 0)

    assert is_inked(-5, -5)
    assert not is_inked(5, -5)
    assert is_inked(2, 2)  # square (1, 1), which is black, beside its mark
    assert not is_inked(5, 5)  # and its mark
    assert is_inked(15, 5)  # the mark in the white square (2, 1)


@pytest.mark.parametrize("name", ["chessboard-9x6", "chessboard-marked-13x8"])
def test_a_code_on_the_print_describes_it(name: str) -> None:
    target = load_target(name)
    described = described_by(code_text(target, 3))
    assert described is not None
    assert described.target == target
    assert described.copy == 3
