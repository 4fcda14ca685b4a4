"""Outlines of the print of an AprilGrid, in millimetres in the target's frame."""

import cv2
import numpy as np
from jaxtyping import Bool
from matplotlib.path import Path as Outline

from labcal.targets.april_grid import AprilGrid
from labcal.targets.charuco_opencv import opencv_dictionary

_SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]])
_CODES = np.array([Outline.MOVETO, Outline.LINETO, Outline.LINETO, Outline.LINETO, Outline.CLOSEPOLY])


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
    """Return the outlines of the tags, of their white cells and of the small squares as one path.

    A tag is one square, and white cells are holes that run the other way round; those that touch in a row are
    one hole. Squares at corners that lie between tags are drawn once.
    """
    black = tag_cells(grid)
    cells = black.shape[1]
    pitch = 1.0 + grid.tag_spacing
    boxes, holes = [], []
    for number, is_black in enumerate(black):
        corner = pitch * np.array(divmod(number, grid.tag_cols)[::-1])
        boxes.append([*corner, 1.0, 1.0])
        for row, cells_of_row in enumerate(~is_black):
            ends = np.flatnonzero(np.diff(np.concatenate([[0], cells_of_row.astype(int), [0]])))
            for first, end in zip(ends[::2], ends[1::2], strict=True):
                x, y = corner + np.array([first, cells - 1 - row]) / cells
                holes.append([x, y, (end - first) / cells, 1.0 / cells])
    if grid.corner_squares:
        i, j = (k.ravel() for k in np.meshgrid(np.arange(grid.tag_cols + 1), np.arange(grid.tag_rows + 1)))
        size = grid.tag_spacing
        boxes += [[pitch * a - size, pitch * b - size, size, size] for a, b in zip(i, j, strict=True)]
    box, hole = np.array(boxes), np.array(holes).reshape(-1, 4)
    solid = box[:, None, :2] + _SQUARE * box[:, None, 2:]
    empty = hole[:, None, :2] + _SQUARE[::-1] * hole[:, None, 2:]
    vertices = np.concatenate([solid, empty]).reshape(-1, 2)
    return Outline(vertices * grid.tag_mm * grid.scale_x_y, np.tile(_CODES, len(box) + len(hole)))
