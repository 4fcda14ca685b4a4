"""A print whose dots were measured: shifts listed in the board."""

import numpy as np
import pytest

from labcal.errors import InputError
from labcal.scene.board import Board
from labcal.scene.print import TruePrint
from labcal.targets.catalogue import load_target
from labcal.targets.grid import DotGrid


def _target() -> DotGrid:
    target = load_target("rings-10x8")
    assert isinstance(target, DotGrid)
    return target


def test_dots_lie_at_their_listed_places() -> None:
    target = _target()
    shifts = 0.01 * np.random.default_rng(3).standard_normal((target.count, 2))
    board = Board(dot_shifts_mm=tuple((float(x), float(y)) for x, y in shifts))
    made = TruePrint.of(target, board, 0)
    np.testing.assert_allclose(made.centres[:, :2], target.points()[:, :2] + shifts, atol=1e-12)
    assert made.is_displaced


def test_a_list_of_another_length_is_refused() -> None:
    with pytest.raises(InputError, match="lists 1 dots"):
        TruePrint.of(_target(), Board(dot_shifts_mm=((0.0, 0.0),)), 0)


def test_a_board_without_shifts_does_not_mention_them() -> None:
    assert "dot_shifts_mm" not in Board().model_dump()
    assert "dot_shifts_mm" in Board(dot_shifts_mm=((0.0, 0.1),)).model_dump()
