"""Outlines of the print of an AprilGrid, in millimetres in the target's frame."""

import cv2
import numpy as np
from jaxtyping import Bool
from matplotlib.path import Path as Outline

from labcal.targets.april_grid import AprilGrid
from labcal.targets.cell_outlines import cell_outlines, moved
from labcal.targets.charuco_opencv import opencv_dictionary


def tag_cells(grid: AprilGrid) -> Bool[np.ndarray, "tags cells cells"]:
    """Return which cells of every tag are black, the top row first, in the order of ids.

    Kalibr prints the most significant bit of a tag's code at the upper left; OpenCV's pictures of the same
    tags are turned by half a turn against that.
    """
    dictionary = opencv_dictionary(grid.dictionary)
    cells = dictionary.markerSize + 2 * grid.border_cells
    pictures = [
        cv2.rotate(
            dictionary.generateImageMarker(grid.first_id + k, cells, borderBits=grid.border_cells),
            cv2.ROTATE_180,
        )
        for k in range(grid.tag_count)
    ]
    return np.asarray(np.stack(pictures) == 0)


def april_grid_outlines(grid: AprilGrid) -> Outline:
    """Return the outlines of the tags and of the small squares as one path.

    Squares at corners that lie between tags are drawn once.
    """
    black = tag_cells(grid)
    cell = 1.0 / black.shape[1]
    size, pitch = grid.tag_spacing, 1.0 + grid.tag_spacing
    parts = [
        moved(cell_outlines(is_black), cell, pitch * np.array(divmod(number, grid.tag_cols)[::-1]))
        for number, is_black in enumerate(black)
    ]
    if grid.corner_squares:
        square = cell_outlines(np.ones((1, 1), dtype=bool))
        i, j = (k.ravel() for k in np.meshgrid(np.arange(grid.tag_cols + 1), np.arange(grid.tag_rows + 1)))
        parts += [moved(square, size, pitch * np.array(place) - size) for place in zip(i, j, strict=True)]
    every = Outline.make_compound_path(*parts)
    return Outline(np.asarray(every.vertices) * grid.tag_mm * grid.scale_x_y, every.codes)
