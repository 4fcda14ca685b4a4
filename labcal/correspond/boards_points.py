"""Points of several boards as points of one target, and back to the boards."""

from collections.abc import Collection
from dataclasses import replace
from typing import TypeVar

import numpy as np
from jaxtyping import Int64

from labcal.correspond.boards_table import numbers_of_boards, require_board
from labcal.correspond.matching import Matches
from labcal.correspond.points import Points
from labcal.errors import InputError
from labcal.targets.board_set import BoardSet
from labcal.targets.target import Target
from labcal.wording import listed

Numbered = TypeVar("Numbered", Points, Matches)
"""Points or pixels with the numbers of a target."""


def points_on_target(points: Points, target: Target) -> Points:
    """Return points with the numbers of a target, which may be a set of boards.

    Parameters
    ----------
    points : Points
        With the board of each point where views show several.
    target : Target
        A set: its dots are numbered one after the other, board by board. One board: the points of other
        boards are left out.

    Raises
    ------
    InputError
        The points do not state boards, though the target has several; a board is none of the target's, or a
        point is of a dot that its board does not have.
    """
    if not isinstance(target, BoardSet):
        return _of_one(points, target)
    if not points.boards:
        if len(points) == 0:
            return points
        raise InputError(
            f"The points do not state their boards, but '{target.name}' has several "
            f"({listed(target.names)}). Reconstruct them from a table of dots with the column 'board', "
            "which 'detect' writes of several targets."
        )
    index, inside = numbers_of_boards(points.index, points.board, target)
    if not inside.all():
        lost = int(np.argmin(inside))
        (col, row), name = points.index[lost].tolist(), str(points.board[lost])
        if not name:
            raise InputError(
                f"The point ({col}, {row}) in view '{points.view[lost]}' states no board. State that of each."
            )
        board = target.board_of_name(name)
        raise InputError(
            f"There is a point of dot ({col}, {row}) of board '{name}', which has {board.cols} x "
            f"{board.rows} dots. Name the boards that the points are of."
        )
    return replace(points, index=index, board=np.full(len(points), ""))


def points_of_boards(points: Points, boards: BoardSet) -> Points:
    """Return points of a set with each board's own columns and rows beside its name."""
    index, board = own_indices(points.index, boards)
    return replace(points, index=index, board=board)


def own_indices(
    index: Int64[np.ndarray, "n 2"], boards: BoardSet
) -> tuple[Int64[np.ndarray, "n 2"], np.ndarray]:
    """Return (col, row) of dots (n, 0) on their boards, and the names of these."""
    numbers = index[:, 0]
    names = np.array(boards.names, dtype=np.str_)[boards.board_number[numbers]]
    return boards.own_indices()[numbers].astype(np.int64), names


def with_known_lengths(lines: Numbered, target: Target) -> Numbered:
    """Return lines whose views hold only dots of which the target states the distances.

    Where the places of boards are not known, or boards move separately, the dots of each board become a view
    of their own, named ``VIEW-BOARD``.

    Parameters
    ----------
    lines : Points or Matches
        With the numbers of the target.
    target : Target
    """
    if not isinstance(target, BoardSet) or target.places is not None:
        return lines
    _, names = own_indices(lines.index, target)
    views = [f"{view}-{name}" for view, name in zip(lines.view, names, strict=True)]
    return replace(lines, view=np.array(views, dtype=np.str_))


def with_views_of_boards(views: Collection[str] | None, target: object) -> Collection[str] | None:
    """Return names of views, and those that :func:`with_known_lengths` gives to their boards."""
    if views is None or not isinstance(target, BoardSet):
        return views
    return [*views, *(f"{view}-{name}" for view in views for name in target.names)]


def _of_one(points: Points, target: Target) -> Points:
    """Return the points of one board; points that state no boards as they are."""
    if not points.boards:
        return points
    require_board(points.boards, target, "The points are of")
    mine = points.where(points.board == target.name)
    return replace(mine, board=np.full(len(mine), ""))
