"""Outlines of the print of a board, in millimetres in the target's frame."""

import numpy as np
from matplotlib.path import Path as Outline

from labcal.errors import InputError
from labcal.targets.catalogue import AnyTarget
from labcal.targets.charuco import CharucoBoard
from labcal.targets.charuco_opencv import markers
from labcal.targets.grid import DotGrid
from labcal.targets.registry import kind_of, run_part

_SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]])


def printed_outlines(target: AnyTarget) -> Outline:
    """Return the outlines of all that is printed on the bare board, as the target's kind has them.

    Raises
    ------
    InputError
        The kind is a user's, and fails or returns no path.
    """
    kind = kind_of(target)
    outlines = run_part(kind, "outlines", target)
    if not (isinstance(outlines, Outline) and np.isfinite(outlines.vertices).all()):
        raise InputError(
            f"The kind of target '{kind.name}': its 'outlines' should return a matplotlib.path.Path of "
            f"finite places, not {type(outlines).__name__}."
        )
    return outlines


def dot_outlines(grid: DotGrid) -> Outline:
    """Return the outlines of all dots as one path.

    The hole of a ring runs the other way round, so that filling leaves it empty. A circle is matplotlib's,
    eight cubic curves, true to 1e-5 of the radius.
    """
    circle = Outline.unit_circle()
    vertices = np.asarray(circle.vertices)
    # The last vertex belongs to "close" and has no place of its own.
    reversed_vertices = np.concatenate([vertices[-2::-1], vertices[-1:]])
    centres = grid.points()[:, :2]
    radii = grid.outer_diameters_mm() / 2
    outer = centres[:, None] + radii[:, None, None] * vertices
    holes = np.array([centres[row * grid.cols + col] for col, row in grid.ring_indices]).reshape(-1, 1, 2)
    inner = holes + (grid.ring_inner_diameter_mm or 0.0) / 2 * reversed_vertices
    circles = np.concatenate([outer, inner])
    return Outline(circles.reshape(-1, 2), np.tile(np.asarray(circle.codes), len(circles)))


def charuco_outlines(board: CharucoBoard) -> Outline:
    """Return the outlines of the black squares and of the black cells of the markers.

    Cells that touch in a row of a marker are one rectangle, so that a viewer draws no hairlines between them.
    """
    across, up = board.squares
    i, j = (k.ravel() for k in np.meshgrid(np.arange(across), np.arange(up)))
    black = board.is_black(i, j)
    corners = np.stack([i[black] - 1.0, j[black] - 1.0], axis=-1) * board.square_mm
    boxes = [np.concatenate([corner, [board.square_mm, board.square_mm]]) for corner in corners]
    found = markers(board)
    cells = found.is_black.shape[1]
    cell = board.marker_mm / cells
    for corner, is_black in zip(found.corner, found.is_black, strict=True):
        for row, first, length in _runs(is_black):
            place = corner + cell * np.array([first, cells - 1 - row])
            boxes.append(np.concatenate([place, [cell * length, cell]]))
    box = np.array(boxes)
    vertices = box[:, None, :2] + _SQUARE * box[:, None, 2:]
    codes = [Outline.MOVETO, Outline.LINETO, Outline.LINETO, Outline.LINETO, Outline.CLOSEPOLY]
    return Outline(vertices.reshape(-1, 2), np.tile(codes, len(box)))


def _runs(is_black: np.ndarray) -> list[tuple[int, int, int]]:
    """Return the runs of black cells in a marker's rows: row from the top, first column, length."""
    runs = []
    for row, cells in enumerate(is_black):
        ends = np.flatnonzero(np.diff(np.concatenate([[0], cells.astype(int), [0]])))
        runs += [(row, int(a), int(b - a)) for a, b in zip(ends[::2], ends[1::2], strict=True)]
    return runs
