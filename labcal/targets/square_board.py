"""Protocol of boards whose places are the inner corners of black and white squares."""

from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Bool, Int


@runtime_checkable
class SquareBoard(Protocol):
    """A board of black and white squares, with what else is printed on it."""

    @property
    def cols(self) -> int:
        """Corners in a row."""

    @property
    def rows(self) -> int:
        """Rows of corners."""

    @property
    def corner_gap(self) -> float:
        """White between a corner's edges and the nearest markers, in squares; 1 where there are none."""

    def clear_reach(self, col: int, row: int) -> float:
        """Return how far from a corner's edges the squares around it are plain, in squares; 1 if wholly."""

    def is_black(self, i: Int[np.ndarray, "*n"], j: Int[np.ndarray, "*n"]) -> Bool[np.ndarray, "*n"]:
        """Return which squares are black, counted from 0 at the lower left."""
