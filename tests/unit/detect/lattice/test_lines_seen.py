"""Words on the columns and rows of a grid that are seen."""

from collections.abc import Callable

import numpy as np
import pytest

from labcal.detect.lattice.lines_seen import lines_words


def words(turn: int, kept: Callable[[np.ndarray, np.ndarray], np.ndarray] | None = None) -> str:
    """Return the words on 7 columns and 5 rows 10 px apart; `kept` takes (col, row) from the upper left."""
    col, row = (k.ravel() for k in np.meshgrid(np.arange(7), np.arange(5)))
    some = np.ones(len(col), dtype=bool) if kept is None else kept(col, row)
    nodes, q = np.stack([col, row], axis=-1)[some], 10.0 * np.stack([col, row], axis=-1)[some]
    turns = [[[1, 0], [0, 1]], [[0, -1], [1, 0]], [[-1, 0], [0, -1]], [[0, 1], [-1, 0]]]
    return lines_words(nodes @ np.array(turns[turn]), q, "dots", (7, 5))


@pytest.mark.parametrize("turn", range(4))
def test_columns_and_rows_are_counted_however_the_lattice_is_turned(turn: int) -> None:
    where = "between x = 0 and 60 and y = 0 and 40 px"
    assert words(turn) == f"7 columns and 5 rows of dots were seen {where}; the target has 7 and 5."


@pytest.mark.parametrize("turn", range(4))
def test_the_outermost_line_of_which_little_is_seen_is_named(turn: int) -> None:
    assert words(turn, lambda col, row: (col < 6) | (row < 2)).endswith(
        "the target has 7 and 5. Of the rightmost column 2 of 5 dots were seen."
    )
    assert words(turn, lambda col, row: (row > 0) | (col == 3)).endswith(
        "Of the top row 1 of 7 dots were seen."
    )
