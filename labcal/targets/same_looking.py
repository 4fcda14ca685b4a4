"""Boards that a picture would not tell apart."""

from labcal.targets.april_grid import AprilGrid
from labcal.targets.charuco import CharucoBoard
from labcal.targets.chessboard import Chessboard
from labcal.targets.coded_dots import CodedDots
from labcal.targets.grid import DotGrid
from labcal.targets.target import PrintableTarget


def why_same_looking(one: PrintableTarget, other: PrintableTarget) -> str | None:
    """Return why two boards cannot be distinguished in a picture, and what to do; None where they can.

    Markers tell boards by their ids. Rings tell grids of dots where their positions relative to each other
    differ. Plain boards are distinguished by their numbers of columns and rows.
    """
    ids, others = _ids(one), _ids(other)
    if ids is not None and others is not None:
        return _shared_ids(ids, others)
    if isinstance(one, DotGrid) and isinstance(other, DotGrid):
        return _alike_grids(one, other)
    if isinstance(one, Chessboard) and isinstance(other, Chessboard):
        return _alike_chessboards(one, other)
    return None


def _ids(board: PrintableTarget) -> tuple[str, int, int] | None:
    """Return the set of markers of a board, its first id and one past its last; None where it has none."""
    if isinstance(board, CharucoBoard):
        return _family(board.dictionary), board.first_id, board.first_id + board.marker_count
    if isinstance(board, AprilGrid):
        return _family(board.dictionary), board.first_id, board.first_id + board.tag_count
    if isinstance(board, CodedDots):
        return f"marks of {board.code}", board.first_mark, board.first_mark + board.count
    return None


def _family(dictionary: str) -> str:
    """Return the sets of markers of one size: OpenCV's smaller ones are the beginnings of the larger ones."""
    return f"markers of {dictionary.rpartition('_')[0] if 'X' in dictionary else dictionary}"


def _shared_ids(one: tuple[str, int, int], other: tuple[str, int, int]) -> str | None:
    """Return why markers of two boards are mistaken for each other."""
    first, last = max(one[1], other[1]), min(one[2], other[2]) - 1
    if one[0] != other[0] or first > last:
        return None
    mend = "state the ids of each print, or print one with ids of its own"
    return f"both have {one[0]} {first} to {last}; {mend}"


def _alike_grids(one: DotGrid, other: DotGrid) -> str | None:
    """Return why two grids of dots are mistaken for each other."""
    if one.rings is None or other.rings is None:
        if (one.cols, one.rows) == (other.cols, other.rows) or one.rings is other.rings:
            return (
                "grids of dots are distinguished by their rings, and at least one has none; print rings, or "
                "a board with markers"
            )
        return None
    if (one.rings.x_steps, one.rings.y_steps) == (other.rings.x_steps, other.rings.y_steps):
        return (
            "their rings are at the same distances, in dots; use grids with rings elsewhere, or boards with "
            "markers"
        )
    return None


def _alike_chessboards(one: Chessboard, other: Chessboard) -> str | None:
    """Return why two chessboards are mistaken for each other."""
    if one.marks and other.marks:
        return "chessboards with marks are both found in part; use boards with markers and ids of their own"
    if sorted((one.cols, one.rows)) == sorted((other.cols, other.rows)):
        return f"both have {one.cols} x {one.rows} corners; use boards with markers and ids of their own"
    return None
