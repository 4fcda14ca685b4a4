"""Processing of pictures in bands of rows, which limits the memory."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

ROWS = 64
"""Height of a band. It is fixed, since random numbers are drawn band by band."""


@dataclass(frozen=True)
class Band:
    """Rows `first` to `last` (excluded) of a picture; `first` is even, so a Bayer mosaic keeps its phase."""

    first: int
    last: int

    @property
    def rows(self) -> slice:
        """The band's own rows."""
        return slice(self.first, self.last)

    def widened(self, picture: np.ndarray, halo: int) -> np.ndarray:
        """Return the band with up to `halo` more rows on both sides, as far as the picture reaches."""
        return picture[max(0, self.first - halo) : self.last + halo]

    def narrowed(self, wide: np.ndarray, halo: int) -> np.ndarray:
        """Return the rows of the band itself from the result of :meth:`widened` with the same `halo`."""
        above = self.first - max(0, self.first - halo)
        return wide[above : above + self.last - self.first]


def bands(height: int) -> Iterator[Band]:
    """Return the bands of a picture, from the top."""
    for first in range(0, height, ROWS):
        yield Band(first, min(first + ROWS, height))


def strips(height: int, rows: int, halo: int) -> Iterator[tuple[slice, range]]:
    """Yield strips of so many rows of a picture, and each with `halo` more rows on both sides.

    The further rows of the first and the last strip lie beyond the picture.
    """
    for first in range(0, height, rows):
        last = min(first + rows, height)
        yield slice(first, last), range(first - halo, last + halo)
