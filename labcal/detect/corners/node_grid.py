"""Quantities of the corners of a board on the grid of their nodes, and what those around each say."""

from dataclasses import dataclass

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.lattice.lattice import Node


@dataclass(frozen=True)
class NodeGrid:
    """The rectangle of nodes that some corners take up.

    Attributes
    ----------
    nodes : ndarray of int, shape (n, 2)
        (col, row) of every corner, each once.
    """

    nodes: np.ndarray

    @classmethod
    def of(cls, nodes: list[Node]) -> "NodeGrid":
        """Return the grid of at least one node."""
        return cls(np.array(nodes, dtype=np.int64).reshape(-1, 2))

    @property
    def at(self) -> tuple[np.ndarray, np.ndarray]:
        """Place of every corner in an array of the grid."""
        first, second = (self.nodes - self.nodes.min(axis=0)).T
        return first, second

    def spread(self, values: np.ndarray) -> np.ndarray:
        """Return values of the corners (n, ...) on the grid, shape (a, b, ...), NaN where there is none."""
        a, b = (np.ptp(self.nodes, axis=0) + 1).tolist()
        grid = np.full((a, b, *values.shape[1:]), np.nan)
        grid[self.at] = values
        return grid


def around(grid: np.ndarray, reach: int) -> np.ndarray:
    """Return the values (a, b, ...) at all nodes up to `reach` away, shape (k, a, b, ...); NaN beyond."""
    a, b = grid.shape[:2]
    padded = np.full((a + 2 * reach, b + 2 * reach, *grid.shape[2:]), np.nan)
    padded[reach : reach + a, reach : reach + b] = grid
    steps = range(2 * reach + 1)
    return np.array([padded[i : i + a, j : j + b] for i in steps for j in steps])


def median_around(grid: np.ndarray, reach: int) -> np.ndarray:
    """Return the medians of the values (a, b, ...) that there are up to `reach` nodes away; NaN for none."""
    flat = np.ascontiguousarray(grid, dtype=np.float64).reshape(*grid.shape[:2], -1)
    return np.asarray(_medians(flat, reach).reshape(grid.shape))


@compiled
def _medians(grid: np.ndarray, reach: int) -> np.ndarray:
    """Return the medians of values (a, b, m) around every node."""
    wide, high, size = grid.shape
    found, near = np.full((wide, high, size), np.nan), np.empty((2 * reach + 1) ** 2)
    for i in range(wide):
        for j in range(high):
            for k in range(size):
                count = 0
                for a in range(max(i - reach, 0), min(i + reach + 1, wide)):
                    for b in range(max(j - reach, 0), min(j + reach + 1, high)):
                        value = grid[a, b, k]
                        if not np.isfinite(value):
                            continue
                        at = count
                        while at > 0 and near[at - 1] > value:
                            near[at] = near[at - 1]
                            at -= 1
                        near[at] = value
                        count += 1
                if count > 0:
                    found[i, j, k] = 0.5 * (near[(count - 1) // 2] + near[count // 2])
    return found


def ahead(grid: np.ndarray, axis: int) -> np.ndarray:
    """Return the steps from every node to the next one along an axis; NaN at the end."""
    end = np.full_like(np.take(grid, [0], axis=axis), np.nan)
    return np.concatenate([np.diff(grid, axis=axis), end], axis=axis)


def behind(grid: np.ndarray, axis: int) -> np.ndarray:
    """Return the steps to every node from the one before it along an axis; NaN at the beginning."""
    end = np.full_like(np.take(grid, [0], axis=axis), np.nan)
    return np.concatenate([end, np.diff(grid, axis=axis)], axis=axis)
