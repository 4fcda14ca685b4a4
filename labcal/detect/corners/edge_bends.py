"""Curvature of the edges at the corners of a board, as a lens bends them, from the corners beside each."""

import numpy as np

from labcal.detect.corners.node_grid import ahead, behind, median_around

_NEAR = (1, 2, 4)
"""Nodes to either side whose curvatures have one median, against the corners' noise: the nearest known."""


def edge_bends(places: np.ndarray) -> np.ndarray:
    """Return vectors of curvature of the edges along x and along y at corners, 1/px, shape (a, b, 2, 2).

    Three corners of a line determine how it bends at the middle one: the second divided difference of their
    places by the distance along the line, of which only the part across the line is taken. Corners at the end
    of a line have the curvature of those beside them; it is NaN where there is none.

    Parameters
    ----------
    places : ndarray, shape (a, b, 2)
        Measured corners, px, by column and row; NaN where there is none.
    """
    return _smooth(np.stack([_bends(places, axis) for axis in (0, 1)], axis=2))


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


def _bends(places: np.ndarray, axis: int) -> np.ndarray:
    """Return the curvature of lines in one direction of the board, NaN where a neighbour is unknown."""
    after, before = ahead(places, axis), behind(places, axis)
    far, near = (np.linalg.norm(step, axis=-1, keepdims=True) for step in (after, before))
    along = (after + before) / np.linalg.norm(after + before, axis=-1, keepdims=True)
    bend = 2.0 * (after / far - before / near) / (far + near)
    return np.asarray(bend - along * (along * bend).sum(axis=-1, keepdims=True))
