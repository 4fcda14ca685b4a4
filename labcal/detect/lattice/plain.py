"""Ids of a grid whose dots are all alike, by its outermost rows and columns, up to its symmetries.

Nothing marks a dot, so only a grid that is seen from edge to edge can be numbered: a part of it fits at many
places. A symmetric grid looks the same after half a turn, a square one after a quarter; of these numberings
that one is given whose columns run most nearly to the right in the picture, as a board is usually held, and
the others stand in `PictureDots.others`. Several pictures of the same board may resolve the
orientation (`labcal.correspond.orientation`). That a picture is mirrored cannot be seen.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from labcal.arrays import DotIndices
from labcal.detect.checks.missing_dots import UnmeasuredDot
from labcal.detect.dots import PictureDots
from labcal.detect.flags import Refusal
from labcal.detect.lattice.lattice import Lattice, Node
from labcal.detect.lattice.rings import TURNS, Numbering, pitches_agree
from labcal.detect.outlines.outlines import Outlines
from labcal.detect.stage_settings.grid import GridSettings
from labcal.targets.grid import DotGrid, Layout


@dataclass(frozen=True)
class DiagonalNumbering:
    """(col, row) of a lattice node in an asymmetric grid, whose lattice stands on its corner.

    With ``(a, b) = turn @ node``, `a` counts steps to the upper right and `b` steps to the upper left:
    ``a - b`` is the place along x and ``a + b`` the row, in half pitches.
    """

    turn: np.ndarray
    shift: np.ndarray
    """Of place along x and row, so that the grid begins at (0, 0); of even sum."""

    def index(self, node: Node) -> tuple[int, int]:
        """Return (col, row) of a node."""
        half_pitches, row = (int(k) for k in upright(self.turn, np.array([node]))[0] + self.shift)
        return (half_pitches - row % 2) // 2, row

    def indices(self, nodes: np.ndarray) -> np.ndarray:
        """Return (col, row) of nodes, (n, 2)."""
        half_pitches, row = (upright(self.turn, nodes) + self.shift).T
        return np.stack([(half_pitches - row % 2) // 2, row], axis=1)


def number_plain(
    lattice: Lattice, outlines: Outlines, target: DotGrid, settings: GridSettings
) -> Numbering | DiagonalNumbering | Refusal:
    """Find ids for a lattice that is exactly as large as the target's grid.

    All four quarter turns are tried. A turn fits where the lattice has the target's number of columns and of
    rows, and at least half of the dots of each of the four outermost ones; in an asymmetric grid, where the
    shifted rows are the right ones, too. Of fitting turns that the target's own symmetry allows, that one is
    taken whose columns run most nearly to the right in the picture.

    Returns
    -------
    Numbering or DiagonalNumbering or Refusal
        `AMBIGUOUS` where no turn fits, or turns fit between which the target is not symmetric.
    """
    nodes = np.array(list(lattice.spots), dtype=np.int64)
    found = [_fitted(turn, nodes, target, settings.edge_line_share) for turn in TURNS]
    fitting = [numbering for numbering in found if numbering is not None]
    if target.layout is Layout.SYMMETRIC:
        tolerance = settings.pitch_ratio_log
        fitting = [one for one in fitting if pitches_agree(one.turn, lattice, outlines, target, tolerance)]
    alike = 1 + len(target.symmetric_indices(target.indices()[:1]))
    if not fitting or len(fitting) > alike:
        return Refusal.AMBIGUOUS
    return max(fitting, key=lambda found: _uprightness(found.turn, lattice, outlines, target))


def continues_beyond_grid(
    unmeasured: Sequence[UnmeasuredDot],
    numbering: Numbering | DiagonalNumbering,
    target: DotGrid,
    settings: GridSettings,
) -> bool:
    """Tell whether dots are seen beyond the grid, so that its edges are not those of the print."""
    last = (target.cols, target.rows)
    places = np.array([numbering.index(dot.node) for dot in unmeasured], dtype=np.int64).reshape(-1, 2)
    beyond = int(((places < 0) | (places >= last)).any(axis=1).sum())
    return beyond > settings.max_dots_beyond


def with_symmetric_numberings(dots: PictureDots, target: DotGrid) -> PictureDots:
    """Return the dots with every other numbering that fits the picture as well."""
    return dots if dots.refusal is not None else replace(dots, others=target.symmetric_indices(dots.index))


def upright(turn: np.ndarray, nodes: DotIndices) -> DotIndices:
    """Return the places along x and rows of the nodes of an asymmetric grid, in half pitches."""
    a, b = (nodes @ turn.T).T
    return np.stack([a - b, a + b], axis=-1)


def _fitted(
    turn: np.ndarray, nodes: DotIndices, target: DotGrid, edge_share: float
) -> Numbering | DiagonalNumbering | None:
    """Return the numbering of one turn if the nodes fill the grid from edge to edge."""
    if target.layout is Layout.SYMMETRIC:
        places, last = nodes @ turn.T, np.array([target.cols, target.rows]) - 1
        corner_share = np.array([target.rows, target.cols])
    else:
        places, last = upright(turn, nodes), np.array([2 * target.cols, target.rows]) - 1
        corner_share = np.array([target.rows / 2, target.cols])
    low, high = places.min(axis=0), places.max(axis=0)
    if (high - low != last).any():
        return None
    seen = np.minimum((places == low).sum(axis=0), (places == high).sum(axis=0))
    if (seen < edge_share * corner_share).any():
        return None
    if target.layout is Layout.SYMMETRIC:
        return Numbering(turn, -low)
    return DiagonalNumbering(turn, -low) if low.sum() % 2 == 0 else None


def _uprightness(turn: np.ndarray, lattice: Lattice, outlines: Outlines, target: DotGrid) -> float:
    """Return the cosine of the angle by which the board, under a turn, is turned in the picture."""
    nodes = np.array(list(lattice.spots), dtype=np.float64) @ turn.T
    if target.layout is Layout.ASYMMETRIC:
        nodes = np.stack([nodes[:, 0] - nodes[:, 1], nodes[:, 0] + nodes[:, 1]], axis=-1)
    seen = outlines.centre[list(lattice.spots.values())]
    return float(np.cos(turn_in_picture(nodes * _steps(target), seen)))


def _steps(target: DotGrid) -> np.ndarray:
    """Return mm a step of the places of nodes."""
    halves = 0.5 if target.layout is Layout.ASYMMETRIC else 1.0
    return np.array([halves * target.pitch_x_mm, target.pitch_y_mm])


def turn_in_picture(places: np.ndarray, seen: np.ndarray) -> float:
    """Return by how much a board is turned anticlockwise in a picture, radians from -pi to pi.

    It is the rotation in the polar decomposition of the affine map that takes places on the board (n, 2; y
    up) to pixels (n, 2; y down).
    """
    design = np.concatenate([places, np.ones((len(places), 1))], axis=1)
    A = np.linalg.lstsq(design, seen * [1.0, -1.0], rcond=None)[0][:2].T
    return float(np.arctan2(A[1, 0] - A[0, 1], A[0, 0] + A[1, 1]))
