"""Image coverage: the parts of a picture in which dots were found, over all views."""

import numpy as np
from jaxtyping import Int64

from labcal.arrays import Pixels
from labcal.correspond.detections import Detections

COLUMNS, ROWS = 8, 6


def coverage(detections: Detections, camera: str, size: tuple[int, int]) -> Int64[np.ndarray, "6 8"]:
    """Return how many dots lie in each cell of a grid over the picture.

    Parameters
    ----------
    detections : Detections
    camera : str
    size : tuple of int
        Width and height of its pictures, px.

    Returns
    -------
    ndarray of int, shape (6, 8)
        From the top-left cell, rows downwards; dots that are measurements of the declared grid.
    """
    return coverage_of(detections.position[detections.ok & (detections.camera == camera)], size)


def coverage_of(q: Pixels, size: tuple[int, int]) -> Int64[np.ndarray, "6 8"]:
    """Return how many pixels lie in each cell of the same grid.

    Parameters
    ----------
    q : ndarray, shape (n, 2)
        Px.
    size : tuple of int
        Width and height of the picture, px.
    """
    width, height = size
    x, y = q.T
    # The frame begins half a pixel before the centre of the first pixel.
    edges_x = np.linspace(-0.5, width - 0.5, COLUMNS + 1)
    edges_y = np.linspace(-0.5, height - 0.5, ROWS + 1)
    counts, _, _ = np.histogram2d(y, x, bins=(edges_y, edges_x))
    cells: np.ndarray = counts.astype(np.int64)
    return cells
