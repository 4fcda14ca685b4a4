"""Products of pairs of rows, each pair once."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64


@dataclass(frozen=True)
class PackedPairs:
    """The pairs (i, j) with j <= i of so many rows, in the order of a lower triangle read by rows.

    Attributes
    ----------
    size : int
        Number of rows.
    """

    size: int

    @property
    def count(self) -> int:
        """The number of pairs."""
        return self.size * (self.size + 1) // 2

    def row(self, i: int) -> slice:
        """Return where the pairs (i, 0) to (i, i) stand."""
        first = i * (i + 1) // 2
        return slice(first, first + i + 1)

    def multiply(self, rows: Float64[np.ndarray, "size n"], out: Float64[np.ndarray, "pairs n"]) -> None:
        """Write the product of the two rows of every pair."""
        for i in range(self.size):
            np.multiply(rows[: i + 1], rows[i], out=out[self.row(i)])

    def lower(self, square: Float64[np.ndarray, "size size"]) -> Float64[np.ndarray, " pairs"]:
        """Return the lower triangle of a square matrix, packed."""
        return square[np.tril_indices(self.size)]

    def unpacking(self) -> Int64[np.ndarray, " squared"]:
        """Return, for every element of the square matrix read by rows, its place among the pairs."""
        index = np.empty((self.size, self.size), dtype=np.int64)
        rows, columns = np.tril_indices(self.size)
        index[rows, columns] = index[columns, rows] = np.arange(self.count)
        return index.ravel()
