"""Image coverage: the parts of a picture in which dots were found, over all views."""

import numpy as np
from jaxtyping import Int64

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
    width, height = size
    x, y = detections.position[detections.ok & (detections.camera == camera)].T
    # The frame begins half a pixel before the centre of the first pixel.
    edges_x = np.linspace(-0.5, width - 0.5, COLUMNS + 1)
    edges_y = np.linspace(-0.5, height - 0.5, ROWS + 1)
    counts, _, _ = np.histogram2d(y, x, bins=(edges_y, edges_x))
    cells: np.ndarray = counts.astype(np.int64)
    return cells
