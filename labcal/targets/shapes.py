"""Outlines of the print of a board, in millimetres in the target's frame."""

import numpy as np
from matplotlib.path import Path as Outline

from labcal.errors import InputError
from labcal.targets.catalogue import AnyTarget
from labcal.targets.cell_outlines import cell_outlines, moved
from labcal.targets.charuco import CharucoBoard
from labcal.targets.charuco_opencv import markers
from labcal.targets.grid import DotGrid
from labcal.targets.registry import kind_of, run_part


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
    """Return the outlines of the black squares and of the markers."""
    across, up = board.squares
    i, j = np.meshgrid(np.arange(across), np.arange(up))
    squares = moved(cell_outlines(board.is_black(i, j)[::-1]), board.square_mm, np.full(2, -board.square_mm))
    found = markers(board)
    cell = board.marker_mm / found.is_black.shape[1]
    pairs = zip(found.corner, found.is_black, strict=True)
    own = (moved(cell_outlines(is_black), cell, corner) for corner, is_black in pairs)
    return Outline.make_compound_path(squares, *own)
