"""Outlines of black cells, as of a marker or a code, with no sides between cells that touch."""

import numpy as np
from jaxtyping import Bool, Float64
from matplotlib.path import Path as Outline

Corner = tuple[int, int]

_SIDES = (
    ((0, 0), (1, 0), (0, -1)),
    ((1, 0), (1, 1), (1, 0)),
    ((1, 1), (0, 1), (0, 1)),
    ((0, 1), (0, 0), (-1, 0)),
)
"""Of a cell, anticlockwise: from which corner to which one, and where the cell across it is."""


def cell_outlines(is_black: Bool[np.ndarray, "rows cols"]) -> Outline:
    """Return the outlines of black cells as one path, anticlockwise; holes run the other way round.

    Cells that share a side have none there: whoever measures distances from the edges of ink finds no edge
    within it, and viewers draw no hairlines. Cells that touch at a corner alone have outlines of their own.

    Parameters
    ----------
    is_black : ndarray of bool, shape (rows, cols)
        The top row first.

    Returns
    -------
    Path
        In cells, y up, with the lower left corner of all cells at (0, 0).
    """
    polygons = [_corners(loop) for loop in _loops(is_black[::-1])]
    if not polygons:
        return Outline(np.zeros((0, 2)), np.zeros(0, dtype=Outline.code_type))
    codes = [
        [Outline.MOVETO, *[Outline.LINETO] * (len(corners) - 2), Outline.CLOSEPOLY] for corners in polygons
    ]
    return Outline(np.concatenate(polygons), np.concatenate(codes))


def moved(outlines: Outline, scale: float, to: Float64[np.ndarray, "2"]) -> Outline:
    """Return outlines, larger by a factor, with their origin at a place."""
    return Outline(np.asarray(outlines.vertices) * scale + to, outlines.codes)


def _loops(is_black: Bool[np.ndarray, "rows cols"]) -> list[list[Corner]]:
    """Return the closed walks along the sides with ink on the left and none on the right; row 0 is lowest."""
    padded = np.pad(is_black, 1)
    ways: dict[Corner, list[Corner]] = {}
    for row, col in np.argwhere(is_black).tolist():
        for (x, y), (to_x, to_y), (across, up) in _SIDES:
            if not padded[1 + row + up, 1 + col + across]:
                ways.setdefault((col + x, row + y), []).append((col + to_x, row + to_y))
    loops = []
    while ways:
        loop = [next(iter(ways))]
        while len(loop) == 1 or loop[-1] != loop[0]:
            at, ends = loop[-1], ways[loop[-1]]
            loop.append(ends.pop(_leftmost(loop, ends)))
            if not ends:
                del ways[at]
        loops.append(loop)
    return loops


def _leftmost(loop: list[Corner], ends: list[Corner]) -> int:
    """Return which of one or two ways on turns left, so that a walk stays with the same cell."""
    if len(loop) == 1 or len(ends) == 1:
        return 0
    (from_x, from_y), (x, y), (to_x, to_y) = loop[-2], loop[-1], ends[0]
    return 0 if (x - from_x) * (to_y - y) > (y - from_y) * (to_x - x) else 1


def _corners(loop: list[Corner]) -> Float64[np.ndarray, "corners 2"]:
    """Return the corners of a closed walk, without those where it goes straight on; the last is the first."""
    walk = np.array(loop[:-1])
    turns = ((np.roll(walk, -1, axis=0) - walk) != (walk - np.roll(walk, 1, axis=0))).any(axis=1)
    kept = walk[turns]
    return np.concatenate([kept, kept[:1]]).astype(np.float64)
