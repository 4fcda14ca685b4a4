"""Tables of dots of several boards as dots of one target, and back to the boards."""

import logging
from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Int64

from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.targets.board_set import BoardSet, Mounting
from labcal.targets.catalogue import AnyTarget
from labcal.targets.target import Target
from labcal.wording import listed

_LOG = logging.getLogger(__name__)


def on_target(table: Detections, target: Target) -> Detections:
    """Return the dots of a table with the numbers of a target, which may be a set of boards.

    Parameters
    ----------
    table : Detections
        With the board of each dot where pictures show several.
    target : Target
        A set: its dots are numbered one after the other, board by board, and views of boards that move
        separately become views of their own, named ``VIEW-BOARD``. One board: the dots of other boards are
        left out.

    Raises
    ------
    InputError
        The table does not state boards, though the target has several; a board in it is none of the target's,
        or a dot is not on its board.
    """
    found = in_one_frame(table, target)
    if isinstance(target, BoardSet) and target.mounting is Mounting.SEPARATE and table.boards:
        return by_board(found, table.board)
    return found


def in_one_frame(table: Detections, target: Target) -> Detections:
    """Return the dots of a table with the numbers of a target, as :func:`on_target`, in the same views.

    Boards that move separately stay in the view that shows them, too.

    Raises
    ------
    InputError
        As of :func:`on_target`.
    """
    if not isinstance(target, BoardSet):
        return _of_one(table, target)
    if not table.boards:
        if len(table) == 0 or not table.has_id.any():
            return table
        raise InputError(
            f"The table does not state the boards of its dots, but '{target.name}' has several "
            f"({listed(target.names)}). Find the dots by the same targets in one table: "
            "`target=['A', 'B']` of 'detect', which names the board of each."
        )
    index, inside = numbers_of_boards(table.index, table.board, target)
    lost = np.flatnonzero(~inside & table.ok & (table.board != ""))
    if len(lost):
        board = target.board_of_name(str(table.board[lost[0]]))
        raise InputError(
            f"{table.words(int(lost[0]))} is not on the board, which has {board.cols} x {board.rows}. Name "
            "the boards that the pictures show."
        )
    return replace(table, index=index, board=np.full(len(table), ""))


def numbers_of_boards(
    index: Int64[np.ndarray, "n 2"], board: np.ndarray, target: BoardSet
) -> tuple[Int64[np.ndarray, "n 2"], Bool[np.ndarray, " n"]]:
    """Return (n, 0) of dots in a set, and a mask of those that are on their board.

    Parameters
    ----------
    index : ndarray of int, shape (n, 2)
        (col, row) on the board.
    board : ndarray of str, shape (n,)
        Names of the boards; empty where there is none.
    target : BoardSet

    Raises
    ------
    InputError
        A board is none of the target's.
    """
    unknown = [name for name in dict.fromkeys(board.tolist()) if name and name not in target.names]
    if unknown:
        raise InputError(
            f"The table holds dots of the board '{unknown[0]}', but '{target.name}' has "
            f"{listed(target.names)}. Name the boards by which the dots were found."
        )
    numbered, inside = np.zeros_like(index), np.zeros(len(index), dtype=bool)
    for one, span in zip(target.targets, target.spans, strict=True):
        mine = board == one.name
        col, row = index[mine].T
        inside[mine] = (col >= 0) & (row >= 0) & (col < one.cols) & (row < one.rows)
        numbered[mine, 0] = np.where(inside[mine], span.start + row * one.cols + col, 0)
    return numbered, inside


def each_board(table: Detections, target: AnyTarget) -> tuple[Detections, AnyTarget]:
    """Return dots and target for work that takes one board a view: of a set, each board is a view of its own.

    Raises
    ------
    InputError
        As of :func:`on_target`.
    """
    if isinstance(target, BoardSet):
        target = target.model_copy(update={"mounting": Mounting.SEPARATE, "places": None})
    return on_target(table, target), target


def by_board(table: Detections, board: np.ndarray) -> Detections:
    """Return a table in which the dots of each board are a view of their own, named ``VIEW-BOARD``.

    Parameters
    ----------
    table : Detections
    board : ndarray of str, shape (n,)
        Names of the boards; of dots without an id, which stay in their view, empty.
    """
    named = [f"{view}-{name}" if name else view for view, name in zip(table.view, board, strict=True)]
    return replace(table, view=np.array(named, dtype=np.str_))


def require_board(stated: tuple[str, ...], target: Target, held: str) -> None:
    """Require that lines of several boards hold one, and log that those of the others do not count.

    Parameters
    ----------
    stated : tuple of str
        Names of the boards in the lines.
    target : Target
        One board.
    held : str
        Beginning of the sentence that names the boards: ``"The table holds dots of"``.

    Raises
    ------
    InputError
        There is no line of the board.
    """
    if target.name not in stated:
        raise InputError(
            f"{held} the boards {listed(stated)}, and none of '{target.name}'. Name one of these boards, or "
            "all of them."
        )
    others = [name for name in stated if name != target.name]
    if others:
        _LOG.warning(
            "The target is '%s' alone: the dots of %s are left out. Name all boards to take them together.",
            target.name,
            listed(others),
        )


def _of_one(table: Detections, target: Target) -> Detections:
    """Return the dots of one board of a table; a table that states no boards as it is."""
    if not table.boards:
        return table
    require_board(table.boards, target, "The table holds dots of")
    mine = table.where((table.board == target.name) | (table.board == ""))
    return replace(mine, board=np.full(len(mine), ""))
