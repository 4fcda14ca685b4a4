"""Held-out points in whole regions, and the choice of the simplest model that predicts them well."""

from collections.abc import Iterator, Sequence

import numpy as np
from jaxtyping import Bool, Float64

from labcal.arrays import Pixels

_SLABS = 4
_EDGE = 0.04
"""Share of the points, those nearest to an edge of all in the picture, that are held out together."""
_SURE = 1.0
"""Standard errors by which a model must be better than one with fewer parameters."""

Fold = Bool[np.ndarray, " n"]
"""Mask of held-out points."""


def folds(q: Pixels, depth: Float64[np.ndarray, " n"]) -> Iterator[Fold]:
    """Return masks of held-out points: each edge in the picture, then slabs of depth.

    Points drawn at random have neighbours among those that stay, so that too flexible a model goes unnoticed.

    Parameters
    ----------
    q : ndarray, shape (n, 2)
        Pixels.
    depth : ndarray, shape (n,)
        Any measure of it.
    """
    yield from edges(q)
    order = np.argsort(np.argsort(depth, kind="stable"), kind="stable")
    for slab in range(_SLABS):
        yield order * _SLABS // len(depth) == slab


def edges(q: Pixels) -> Iterator[Fold]:
    """Return masks of held-out points along each edge of the visible part in the picture."""
    for along in (*q.T, *-q.T):
        yield along >= np.quantile(along, 1.0 - _EDGE)


def simplest(squares: Sequence[Float64[np.ndarray, " tests"]]) -> int:
    """Return the number of the first model that no other one beats by more than chance.

    Parameters
    ----------
    squares : sequence of ndarray, shape (tests,)
        By model, the one with fewest parameters first: squared errors at the same held-out points; infinite
        where there is no prediction, or no model.
    """
    means = [float(np.mean(square)) for square in squares]
    best = int(np.argmin(means))
    for number in range(best):
        if np.isfinite(means[number]):
            worse = squares[number] - squares[best]
            if worse.mean() <= _SURE * worse.std() / np.sqrt(len(worse)):
                return number
    return best
