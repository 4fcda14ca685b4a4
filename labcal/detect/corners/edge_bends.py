"""Curvature of the edges at the corners of a board, as a lens bends them, from the corners beside each."""

import numpy as np

from labcal.arrays import Pixels
from labcal.detect.lattice.lattice import Node

_NEAR = 1
"""Nodes to either side whose curvatures have one median, against the corners' noise."""


def edge_bends(places: dict[Node, np.ndarray]) -> dict[Node, Pixels]:
    """Return vectors of curvature of the edges along x and along y at corners, 1/px, shape (2, 2).

    Three corners of a line determine how it bends at the middle one: the second divided difference of their
    places by the distance along the line, of which only the part across the line is taken. Corners at the end
    of a line have the curvature of those beside them; those without any are left out.

    Parameters
    ----------
    places : dict of (col, row) to ndarray, shape (2,)
        Measured corners, px.
    """
    own = [_bends(places, step) for step in ((1, 0), (0, 1))]
    found = {}
    for col, row in places:
        near = [
            [
                of[col + i, row + j]
                for i in range(-_NEAR, _NEAR + 1)
                for j in range(-_NEAR, _NEAR + 1)
                if (col + i, row + j) in of
            ]
            for of in own
        ]
        if near[0] and near[1]:
            found[col, row] = np.array([np.median(one, axis=0) for one in near])
    return found


def _bends(places: dict[Node, np.ndarray], step: Node) -> dict[Node, np.ndarray]:
    """Return the curvature of lines in one direction of the board, where both neighbours are known."""
    found = {}
    for (col, row), q in places.items():
        after, before = places.get((col + step[0], row + step[1])), places.get((col - step[0], row - step[1]))
        if after is None or before is None:
            continue
        ahead, behind = after - q, q - before
        far, near = float(np.linalg.norm(ahead)), float(np.linalg.norm(behind))
        along = (after - before) / np.linalg.norm(after - before)
        bend = 2.0 * (ahead / far - behind / near) / (far + near)
        found[col, row] = bend - along * (along @ bend)
    return found
