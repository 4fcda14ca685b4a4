"""Curvature of the edges at the corners of a board, as a lens bends them, from the corners beside each."""

import numpy as np

from labcal.detect.corners.node_grid import ahead, behind, median_around

_NEAR = 1
"""Nodes to either side whose curvatures have one median, against the corners' noise."""


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
    return np.stack([median_around(_bends(places, axis), _NEAR) for axis in (0, 1)], axis=2)


def _bends(places: np.ndarray, axis: int) -> np.ndarray:
    """Return the curvature of lines in one direction of the board, NaN where a neighbour is unknown."""
    after, before = ahead(places, axis), behind(places, axis)
    far, near = (np.linalg.norm(step, axis=-1, keepdims=True) for step in (after, before))
    along = (after + before) / np.linalg.norm(after + before, axis=-1, keepdims=True)
    bend = 2.0 * (after / far - before / near) / (far + near)
    return np.asarray(bend - along * (along * bend).sum(axis=-1, keepdims=True))
