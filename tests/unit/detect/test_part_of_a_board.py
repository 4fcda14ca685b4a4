"""A part of a board whose dots are all alike: measured, refused, and with every place where it fits."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from labcal.bench.boards.chessboard_picture import PLAIN as CHESSBOARD
from labcal.bench.boards.chessboard_picture import _ink
from labcal.bench.marks.drawn_picture import Exposure, drawn, tilted
from labcal.detect.detector import detect_dots
from labcal.detect.flags import Refusal
from labcal.targets.catalogue import load_target

MakeBoard = Callable[..., Any]


@pytest.mark.parametrize("name", ["plain-11x8", "asymmetric-4x11"])
def test_a_part_of_a_grid_has_the_true_numbering_among_those_that_fit(
    name: str, make_board: MakeBoard
) -> None:
    target = load_target(name)
    aim = (0.9, 0.5) if name == "plain-11x8" else (0.5, 0.9)
    board = make_board(
        target, rotation=(20, -15, 8), focal=330.0, distance=300.0, size=(320, 320), noise=1.0, aim=aim
    )
    dots = detect_dots(np.clip(np.round(board.draw()), 0, 255).astype(np.uint8), target)
    assert dots.refusal is Refusal.AMBIGUOUS
    assert not dots.has_id.any()
    part = dots.part
    assert part is not None
    assert part.ok.sum() >= 9
    numberings = (part.index, *part.others)
    for index in numberings:
        assert ((index >= 0) & (index < [target.cols, target.rows])).all()
    errors = [
        max(
            np.abs(q - board.centroid(tuple(key))).max()
            for key, q in zip(index[part.ok].tolist(), part.position[part.ok], strict=True)
        )
        for index in numberings
    ]
    assert sum(error < 0.1 for error in errors) == 1


def test_a_part_of_a_chessboard_has_the_true_numbering_among_those_that_fit() -> None:
    H = tilted(0.4, 0.7, 0.3, 400.0 / 18.0, 400.0)
    places = np.column_stack([CHESSBOARD.points()[:, :2], np.ones(CHESSBOARD.count)]) @ H.T
    x, y = np.median(places[:, :2] / places[:, 2:], axis=0)
    H = np.array([[1.0, 0, 25.0 - x], [0, 1.0, 120.0 - y], [0, 0, 1.0]]) @ H  # a good half is in the picture
    how = Exposure((320, 240), H, 0.8, np.zeros(2), 0.01)
    dots = detect_dots(drawn(how, _ink(CHESSBOARD), (), np.random.default_rng(1)), CHESSBOARD)
    assert dots.refusal is Refusal.BOARD_IN_PART
    part = dots.part
    assert part is not None
    off = [
        np.abs(part.position[part.ok] - how.seen(CHESSBOARD.points(index[part.ok])[:, :2])).max()
        for index in (part.index, *part.others)
    ]
    assert sum(error < 0.2 for error in off) == 1
