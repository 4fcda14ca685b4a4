"""Curvature of the edges at the corners of a board, as a lens bends them, from the corners beside each."""

from math import hypot

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.corners.node_grid import median_around

_NEAR = (1, 2, 4)
"""Nodes to either side whose curvatures have one median, against the corners' noise: the nearest known."""


def edge_bends(places: np.ndarray, by_lens: np.ndarray | None = None) -> np.ndarray:
    """Return vectors of curvature of the edges along x and along y at corners, 1/px, shape (a, b, 2, 2).

    Three corners of a line determine how it bends at the middle one: the second divided difference of their
    places by the distance along the line, of which only the part across the line is taken. Corners at the end
    of a line have the curvature of those beside them; it is NaN where there is none.

    Parameters
    ----------
    places : ndarray, shape (a, b, 2)
        Measured corners, px, by column and row; NaN where there is none.
    by_lens : ndarray, shape (a, b, 2), optional
        The same as a lens shows them. The curvature is then what is left of that of the measured ones.
    """
    bends = _bends(np.ascontiguousarray(places))
    return _smooth(bends if by_lens is None else bends - _bends(np.ascontiguousarray(by_lens)))


def across_edges(bends: np.ndarray, states: np.ndarray) -> np.ndarray:
    """Return how much the edges of fits bend towards their normals, 1/px, shape (n, 2).

    Parameters
    ----------
    bends : ndarray, shape (n, 2, 2)
        Vectors of curvature along x and along y.
    states : ndarray, shape (n, PARAMETERS)
        Of the fits.
    """
    # The first normal is that of the edge along y, the second one that of the edge along x.
    normals = np.stack([np.cos(states[:, 2:4]), np.sin(states[:, 2:4])], axis=-1)
    return np.asarray((normals * bends[:, ::-1]).sum(axis=-1))


def _smooth(bends: np.ndarray) -> np.ndarray:
    """Return the medians of curvatures (a, b, 2, 2) around every node, as near by as there are any."""
    smooth = median_around(bends, _NEAR[0])
    for reach in _NEAR[1:]:
        if np.isnan(smooth).any():
            smooth = np.where(np.isnan(smooth), median_around(bends, reach), smooth)
    return smooth


@compiled
def _bends(places: np.ndarray) -> np.ndarray:
    """Return the curvature of lines in both directions of the board, NaN where a neighbour is unknown."""
    wide, high, _ = places.shape
    found = np.full((wide, high, 2, 2), np.nan)
    for i in range(wide):
        for j in range(high):
            for axis in range(2):
                right, up = 1 - axis, axis
                if not (right <= i < wide - right and up <= j < high - up):
                    continue
                here, after, before = places[i, j], places[i + right, j + up], places[i - right, j - up]
                x, y, u, v = after[0] - here[0], after[1] - here[1], here[0] - before[0], here[1] - before[1]
                far, near, whole = hypot(x, y), hypot(u, v), hypot(x + u, y + v)
                along_x, along_y = (x + u) / whole, (y + v) / whole
                bend_x, bend_y = (
                    2.0 * (x / far - u / near) / (far + near),
                    2.0 * (y / far - v / near) / (far + near),
                )
                along = along_x * bend_x + along_y * bend_y
                found[i, j, axis, 0], found[i, j, axis, 1] = (
                    bend_x - along_x * along,
                    bend_y - along_y * along,
                )
    return found
