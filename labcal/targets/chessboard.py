"""The chessboard: black and white squares, whose inner corners are measured; a few may carry marks."""

from enum import StrEnum
from typing import Annotated, Literal

import numpy as np
from jaxtyping import Bool, Int
from pydantic import ConfigDict, Field, model_validator

from labcal.arrays import DotIndices, Lengths, Vectors3
from labcal.bounds import MOST_DOTS, Length, Margin
from labcal.run.names import Name
from labcal.targets.corner_board import CornerBoard

Corners = Annotated[int, Field(ge=3, le=200)]
"""Inner corners along a side; with two of them no corner has neighbours on all four sides."""
MarkedSquare = tuple[Annotated[int, Field(ge=0)], Annotated[int, Field(ge=0)]]
MOST_MARKS = 20


class SquareColour(StrEnum):
    """Colour of a square."""

    BLACK = "black"
    WHITE = "white"


class Chessboard(CornerBoard):
    """A flat target with the inner corners of a chessboard, as many as OpenCV's `patternSize` states.

    Corners are numbered (col, row) from 0, x to the right, y up, z out of the board; corner (0, 0), the lower
    left inner one, is the origin of the target's frame. Lengths are in millimetres. Squares are counted from
    (0, 0) at the lower left; `marks` are round dots of the opposite colour in the middle of some squares, as
    on OpenCV's radon chessboards: with them a part of the board can be numbered.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["chessboard"]
    """Kind of the target."""
    name: Name
    """Name of the target: letters, digits and hyphens."""
    description: str = ""
    """Description of the target, for people."""
    cols: Corners
    """Inner corners in a row: squares less one."""
    rows: Corners
    """Rows of inner corners: squares less one."""
    square_mm: Length
    """Side of a square."""
    lower_left: SquareColour = SquareColour.BLACK
    """Colour of the lower left square."""
    marks: Annotated[tuple[MarkedSquare, ...], Field(max_length=MOST_MARKS)] = ()
    """Squares (from the left, from below) with a round dot of the opposite colour; none where left out."""
    mark_share: Annotated[float, Field(ge=0.2, le=0.5)] = 0.34
    """Diameter of such a dot, of a square's side."""
    margin_mm: Margin = 0.0
    """Bare board around the chessboard."""

    @model_validator(mode="after")
    def _fits_together(self) -> "Chessboard":
        if self.count > MOST_DOTS:
            raise ValueError(f"a target has at most {MOST_DOTS} corners, but this one {self.count}")
        if len(set(self.marks)) != len(self.marks):
            raise ValueError("marks: a square stands there twice")
        for square in self.marks:
            if not (0 < square[0] < self.cols and 0 < square[1] < self.rows):
                raise ValueError(
                    f"marks: the square {list(square)} has no inner corner at each of its four corners: "
                    f"squares from [1, 1] to [{self.cols - 1}, {self.rows - 1}] have"
                )
        if self.marks and len(self.symmetric_turns()) > 1:
            raise ValueError(
                "marks: the board looks the same after a turn; move one of them, so that they number the "
                "corners"
            )
        return self

    @property
    def squares(self) -> tuple[int, int]:
        """Squares along x and along y, one more than corners."""
        return self.cols + 1, self.rows + 1

    @property
    def count(self) -> int:
        """Number of corners."""
        return self.cols * self.rows

    @property
    def extent_mm(self) -> tuple[float, float, float, float]:
        """The board's edges ``(x_min, y_min, x_max, y_max)`` in the target's frame."""
        low = -self.square_mm - self.margin_mm
        across, up = (count * self.square_mm + self.margin_mm for count in (self.cols, self.rows))
        x_scale, y_scale = self.scale_x_y.tolist()
        return (low * x_scale, low * y_scale, across * x_scale, up * y_scale)

    @property
    def captions(self) -> tuple[str, str]:
        """Corners; sizes."""
        marked = f", {len(self.marks)} marks" if self.marks else ""
        return (
            f"{self.name}: chessboard with {self.cols} x {self.rows} inner corners{marked}",
            f"squares {self.square_mm:.6g} mm, lower left one {self.lower_left}",
        )

    @property
    def sizes(self) -> tuple[str, str]:
        """Sides of a square; a corner has no size."""
        return f"{self.square_mm:.6g} x {self.square_mm:.6g}", "corner"

    @property
    def corner_gap(self) -> float:
        """Clear white between a corner's edges and what is printed in a white square: a whole square."""
        return 1.0

    def clear_reach(self, col: int, row: int) -> float:
        """Return how far from a corner's edges the squares around it are plain, in squares; 1 if wholly."""
        if not self.marks:
            return 1.0
        around = {(col + i, row + j) for i in (0, 1) for j in (0, 1)}
        return 1.0 if around.isdisjoint(self.marks) else 0.5 - 0.5 * self.mark_share

    def is_black(self, i: Int[np.ndarray, "*n"], j: Int[np.ndarray, "*n"]) -> Bool[np.ndarray, "*n"]:
        """Return which squares are black, counted from 0 at the lower left."""
        first = 0 if self.lower_left is SquareColour.BLACK else 1
        return np.asarray((i + j + first) % 2 == 0)

    @property
    def key_indices(self) -> tuple[tuple[int, int], ...]:
        """The (col, row) of the corners that must be seen to number the others: of marks, else all."""
        if self.marks:
            around = {(i + di, j + dj) for i, j in self.marks for di in (-1, 0) for dj in (-1, 0)}
            return tuple(sorted(around, key=lambda corner: corner[::-1]))
        return tuple((col, row) for row in range(self.rows) for col in range(self.cols))

    def indices(self) -> DotIndices:
        """Return (col, row) of every corner, row by row from corner (0, 0), shape (count, 2), integer."""
        row, col = np.divmod(np.arange(self.count), self.cols)
        return np.stack([col, row], axis=-1)

    def points(self, indices: DotIndices | None = None) -> Vectors3:
        """Return the places of corners (n, 2), or of all, in the target's frame, mm, shape (n, 3)."""
        wanted = self.indices() if indices is None else indices
        places = wanted * self.square_mm * self.scale_x_y
        return np.concatenate([places, np.zeros((len(wanted), 1))], axis=-1)

    def outer_diameters_mm(self) -> Lengths:
        """Return zeros: a corner has no extent, and its image no eccentricity."""
        return np.zeros(self.count)

    def symmetric_turns(self) -> tuple[int, ...]:
        """Return the quarter turns after which the board looks the same, 0 among them.

        Half a turn moves square (i, j) to (cols - i, rows - j), which has its colour where cols + rows is
        even; a quarter turn needs as many rows as columns, and an even number of them.
        """
        turns = [0]
        if (self.cols + self.rows) % 2 == 0:
            turns.append(2)
        if self.cols == self.rows and self.cols % 2 == 0:
            turns += [1, 3]
        marks = set(self.marks)
        return tuple(turn for turn in sorted(turns) if {self._turned(mark, turn) for mark in marks} == marks)

    def symmetric_indices(self, indices: DotIndices) -> tuple[DotIndices, ...]:
        """Return (col, row) of corners under every turn after which the board looks the same.

        Parameters
        ----------
        indices : ndarray of int, shape (n, 2)

        Returns
        -------
        tuple of ndarray
            Nothing, one array, or three; each (n, 2).
        """
        col, row = indices[:, 0], indices[:, 1]
        last_col, last_row = self.cols - 1, self.rows - 1
        turned = {
            1: np.stack([last_row - row, col], axis=-1),
            2: np.stack([last_col - col, last_row - row], axis=-1),
            3: np.stack([row, last_col - col], axis=-1),
        }
        return tuple(turned[turn] for turn in self.symmetric_turns() if turn)

    def _turned(self, square: MarkedSquare, turn: int) -> MarkedSquare:
        """Return where a square of the board comes to lie after quarter turns anticlockwise."""
        i, j = square
        return {0: (i, j), 1: (self.rows - j, i), 2: (self.cols - i, self.rows - j), 3: (j, self.cols - i)}[
            turn
        ]
