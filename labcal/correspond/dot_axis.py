"""The dots of a table in one order, as the dimension ``dot`` of arrays with names."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int64

from labcal.arrays import DotIndices
from labcal.errors import InputError


@dataclass(frozen=True)
class DotAxis:
    """All dots that occur, sorted by row and then column, and which of them each line is."""

    index: DotIndices
    """(dots, 2), (col, row) of each dot."""
    number: Int64[np.ndarray, " lines"]
    """Of each line, the place of its dot."""

    @classmethod
    def of(cls, index: DotIndices) -> "DotAxis":
        """Return the axis of the dots of lines, given their (col, row)."""
        rows_first, number = np.unique(index[:, ::-1], axis=0, return_inverse=True)
        return cls(rows_first[:, ::-1].copy(), number.reshape(-1).astype(np.int64))

    def __len__(self) -> int:
        return len(self.index)

    def require_once(self, place: tuple[np.ndarray, ...], what: str) -> None:
        """Raise where two lines have the same place in the arrays.

        Raises
        ------
        InputError
            A dot is listed twice for a picture, or a view, as `what` says.
        """
        lines = np.column_stack(place)
        _, first = np.unique(lines, axis=0, return_index=True)
        if len(first) < len(lines):
            twice = np.setdiff1d(np.arange(len(lines)), first)[0]
            col, row = self.index[self.number[twice]]
            raise InputError(
                f"Dot ({col}, {row}) is listed twice for a {what}. Keep one line for each dot of a {what}."
            )
