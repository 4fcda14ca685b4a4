"""Scaling of columns to [-1, 1]."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64


@dataclass(frozen=True)
class RangeScaling:
    """Maps every column from its range to [-1, 1], and back.

    Attributes
    ----------
    centre : float64 array
        The middle of each column's range.
    half_range : float64 array
        Half of it; 1 for a constant column, which so becomes 0 and keeps its unit.
    """

    centre: Float64[np.ndarray, " columns"]
    half_range: Float64[np.ndarray, " columns"]

    @classmethod
    def of(cls, values: Float64[np.ndarray, "n columns"]) -> "RangeScaling":
        """Return the scaling for the range of these values."""
        low, high = values.min(axis=0), values.max(axis=0)
        # Halved before adding, so that huge values do not overflow.
        half_range = high / 2 - low / 2
        return cls(low + half_range, np.where(half_range > 0, half_range, 1.0))

    def scaled(self, values: Float64[np.ndarray, "n columns"]) -> Float64[np.ndarray, "n columns"]:
        """Return the values scaled."""
        return np.asarray((values - self.centre) / self.half_range)

    def restored(self, scaled: Float64[np.ndarray, "n columns"]) -> Float64[np.ndarray, "n columns"]:
        """Return scaled values in their own unit again."""
        return np.asarray(scaled * self.half_range + self.centre)
