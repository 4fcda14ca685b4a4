"""Drawn pictures of chessboards over all difficulties of their detection, with the truth of every corner."""

import numpy as np

from labcal.arrays import Mask
from labcal.bench.boards.board_view import (
    HIDDEN,
    IN_SIGHT,
    MOST_TRIES,
    OUT_OF_FRAME,
    BoardPicture,
    Limits,
    axes_at,
    blurred_view,
    random_view,
)
from labcal.bench.marks.drawn_picture import Print, drawn
from labcal.rng import generator
from labcal.targets.chessboard import Chessboard

SQUARE_PX = (11.0, 32.0)
"""Root of the area of a square."""
NARROWEST_PX = 6.0
"""Least height of a square that is seen aslant."""
MOST_BLUR_SHARE = 0.15
"""Most blur as a share of the height of the narrowest square."""
NEIGHBOURS = 3
"""Corners in a row of an outermost line of a plain board that show where it ends."""
WELL_INSIDE = 0.05
"""As `OUT_OF_FRAME`, of a plain board."""
BORDER_SQUARES = 0.6
"""White paper around the squares."""
WHOLE, _KINDS = 0.0, 4
"""Share hidden of every fourth picture."""
PLAIN = Chessboard(kind="chessboard", name="bench-plain", cols=9, rows=6, square_mm=1.0)
MARKED = Chessboard(
    kind="chessboard", name="bench-marked", cols=13, rows=8, square_mm=1.0, marks=((6, 4), (7, 4), (6, 5))
)


class ChessboardPicture(BoardPicture[Chessboard]):
    """A picture of a chessboard."""

    def axes(self, number: int) -> np.ndarray:
        """Return one square along x and y at a corner, px, in columns."""
        return axes_at(self.exposure, self.board.points()[number, :2])


def chessboard_picture(number: int, seed: int) -> ChessboardPicture:
    """Draw one picture; each quantity is drawn from its range.

    Pictures with an even number show a plain board; the others one with marks, which may run out of the
    frame. Something may hide a part of the board, but not in every fourth picture. Draws are repeated until
    the picture is one that should be indexed.

    Parameters
    ----------
    number : int
        Of the picture.
    seed : int
    """
    random = generator(seed, "bench boards", "chessboards", f"picture {number}")
    board = PLAIN if number % 2 == 0 else MARKED
    for _ in range(MOST_TRIES):
        picture = _drawn_once(board, random, WHOLE if number % _KINDS == 0 else HIDDEN)
        if picture is not None:
            return picture
    raise RuntimeError("no picture of a chessboard that could be indexed was drawn")  # the ranges forbid it


def _drawn_once(board: Chessboard, random: np.random.Generator, hidden: float) -> ChessboardPicture | None:
    """Draw a picture, with a share of its corners hidden at most; None where the board does not fit."""
    places = board.points()[:, :2]
    sharp = random_view(places, SQUARE_PX, random, OUT_OF_FRAME if board.marks else WELL_INSIDE)
    if sharp is None:
        return None
    corner, axes = sharp.seen(places), np.array([axes_at(sharp, place) for place in places])
    limits = Limits(NARROWEST_PX, MOST_BLUR_SHARE, inside=0.0, hidden=hidden, of_all=True)
    view = blurred_view(sharp, corner, axes, limits, random)
    if view is None or not _countable(board, view.visible):
        return None
    picture = drawn(view.exposure, _ink(board), view.covers, random)
    return ChessboardPicture(picture, board, view.exposure, corner, view.visible, view.covers)


def _countable(board: Chessboard, visible: Mask) -> bool:
    """Tell whether the picture should be indexed: half of the corners are in sight, and what numbers them.

    That is some neighbouring corners of each outermost line of a plain board, without which nobody can tell
    which corners are seen; and the marks of a marked one, with the corners around them.
    """
    index = board.indices()
    if not board.marks:
        seen = np.zeros((board.cols, board.rows), dtype=bool)
        seen[index[:, 0], index[:, 1]] = visible
        lines = (seen[0], seen[-1], seen[:, 0], seen[:, -1])
        ends = [np.lib.stride_tricks.sliding_window_view(line, NEIGHBOURS).all(axis=1) for line in lines]
        return bool(visible.mean() >= IN_SIGHT and all(end.any() for end in ends))
    around = np.zeros(len(index), dtype=bool)
    for i, j in board.marks:
        around |= (np.abs(index - (np.array([i, j]) - 0.5)) < 1.0).all(axis=1)
    return bool(visible.mean() >= IN_SIGHT and visible[around].all())


def _ink(board: Chessboard) -> Print:
    """Return the print: squares, marks and white paper around them; unit: mm."""

    def ink(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        with np.errstate(invalid="ignore"):  # NaN is behind the camera
            i, j = (np.floor(np.nan_to_num(place, nan=-99.0)).astype(int) + 1 for place in (x, y))
            black = 0.5 + 0.5 * _waves(x) * _waves(y)
            for mark in board.marks:
                round_ = np.hypot(x - mark[0] + 0.5, y - mark[1] + 0.5) < 0.5 * board.mark_share
                black = np.where(round_, 1.0 - black, black)
            on_board = (i >= 0) & (j >= 0) & (i <= board.cols) & (j <= board.rows)
            x_min, y_min, x_max, y_max = board.extent_mm
            paper = (
                (x > x_min - BORDER_SQUARES)
                & (x < x_max + BORDER_SQUARES)
                & (y > y_min - BORDER_SQUARES)
                & (y < y_max + BORDER_SQUARES)
            )
        return np.asarray(np.where(on_board, black, np.where(paper, 0.0, 0.6)))

    return ink


def _waves(x: np.ndarray) -> np.ndarray:
    """Return 1 in every other square along an axis and -1 in the others, linear across a sample at an edge.

    An edge along the rows of samples would else be off by up to half of one.
    """
    down, across = np.gradient(x)
    nearest = np.rint(x)
    off = 2.0 * (x - nearest) / np.hypot(down, across)
    sign = 1.0 - 2.0 * np.mod(nearest, 2.0)
    return np.asarray(-sign * np.clip(off, -1.0, 1.0))
