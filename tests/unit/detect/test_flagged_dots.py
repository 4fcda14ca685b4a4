"""Dots are sorted by their places, and of two at one place neither keeps it."""

import numpy as np

from labcal.detect.flagged_dots import FlaggedDots
from labcal.detect.flags import DotFlag
from labcal.targets.grid import Polarity


def measured(places: list[tuple[int, int]]) -> FlaggedDots:
    n = len(places)
    seen_at = np.arange(2.0 * n).reshape(n, 2)
    alike = np.tile(np.eye(2), (n, 1, 1))
    named = np.ones(n, dtype=bool)
    return FlaggedDots(
        np.array(places), named, (DotFlag.OK,) * n, seen_at, alike, seen_at, alike, np.arange(1.0 * n)
    )


def test_dots_come_by_row_then_column_and_those_without_a_place_last() -> None:
    other = FlaggedDots.not_measured(None, (DotFlag.NO_ID,), np.array([[0.0, -5.0]]), np.eye(2)[None])
    dots = measured([(1, 1), (0, 1), (2, 0)]).joined([other])
    found = dots.collected((8, 8), Polarity.BLACK_ON_WHITE, None)
    assert found.index[:3].tolist() == [[2, 0], [0, 1], [1, 1]]
    assert found.has_id.tolist() == [True, True, True, False]
    assert found.misfit[:3].tolist() == [2.0, 1.0, 0.0]
    assert np.isnan(found.position[3]).all()


def test_of_two_dots_at_one_place_neither_is_trusted() -> None:
    found = measured([(1, 1), (0, 1), (1, 1)]).collected((8, 8), Polarity.BLACK_ON_WHITE, None)
    assert found.has_id.tolist() == [True, False, False]
    assert found.flag == (DotFlag.OK, DotFlag.NO_ID, DotFlag.NO_ID)
    assert found.index.tolist() == [[0, 1], [0, 0], [0, 0]]
    assert found.seen_at[1:, 1].tolist() == [1.0, 5.0]
