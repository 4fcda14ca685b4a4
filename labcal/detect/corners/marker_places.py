"""The markers of a board that are in the places where the board has them, and the corners beside them."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float64, Int64

from labcal.arrays import DotIndices, Pixels
from labcal.detect.corners.marker_agreement import (
    NEAREST,
    ids_seen_again,
    markers_that_agree,
    through_markers,
)
from labcal.detect.corners.seen_markers import SeenMarkers
from labcal.detect.lattice.rough_undistortion import NONE, RoughUndistortion
from labcal.detect.stage_settings.corner import CornerSettings
from labcal.geometry.projective_map import homogeneous, projective_map
from labcal.targets.charuco import CharucoBoard
from labcal.targets.charuco_opencv import opencv_board

_FEW = 3
"""Markers in place, up to which corners further away are begun with."""


@dataclass(frozen=True)
class PlacedMarkers:
    """Markers that are where the board has them.

    Attributes
    ----------
    seen : SeenMarkers
        Each of them once.
    lens : RoughUndistortion
        The lens through which they agree.
    again : list of int
        Ids that are read at another place of the picture, too, where they agree as well.
    """

    seen: SeenMarkers
    lens: RoughUndistortion = NONE
    again: list[int] = field(default_factory=list)

    @property
    def number(self) -> Int64[np.ndarray, " n"]:
        """Ids of them."""
        return self.seen.number

    @property
    def corners(self) -> Float64[np.ndarray, "n 4 2"]:
        """Places of their corners, px."""
        return self.seen.corners


def markers_in_place(
    seen: SeenMarkers,
    board: CharucoBoard,
    settings: CornerSettings,
    lenses: Sequence[RoughUndistortion] = (),
) -> PlacedMarkers:
    """Return the markers that are where the board has them, as seen from one another; none on another board.

    From one marker on, the next nearest one must be where its nearest neighbours in place predict it, by the
    homography of their corners, which a lens bends little from one square to the next; of large markers
    through a wide lens in a roughly undistorted picture. The largest such set
    counts; where there is none, four or more that one homography takes to their places. It must hold two
    markers or more, and at least half of those with ids of the board; and none of
    the others may go on with the chessboard where the board has ended, as those of a print with another
    number of squares, or the other pattern, do.

    Parameters
    ----------
    seen : SeenMarkers
        All of the board's dictionary: those that the board does not have tell of another one, too.
    board : CharucoBoard
    settings : CornerSettings
    lenses : sequence of RoughUndistortion
        Wide ones that are tried.
    """
    every, seen = seen, seen.on(board)
    on_board = _on_board(board)[seen.number - board.first_id]
    best = markers_that_agree(seen, on_board, settings.max_marker_residual_squares, lenses)
    placed = seen.select(np.array(sorted(best.which), dtype=np.int64))
    again = ids_seen_again(seen, on_board, settings.max_marker_residual_squares, best)
    if best.which and not again and _goes_on(every, placed, best.lens, board, settings):
        return PlacedMarkers(SeenMarkers.none())
    return PlacedMarkers(placed, best.lens, again)


@dataclass(frozen=True)
class RoughCorners:
    """Corners of a board as its markers predict them.

    Attributes
    ----------
    index : ndarray of int, shape (m, 2)
        (col, row).
    q : ndarray, shape (m, 2)
        px.
    axes : ndarray, shape (m, 2, 2)
        Columns: one square along the board's x and y there, px.
    beside : ndarray of bool, shape (m,)
        Corners of a marker's own square. The others are further away, and may be hidden.
    """

    index: DotIndices
    q: Pixels
    axes: Float64[np.ndarray, "m 2 2"]
    beside: Bool[np.ndarray, " m"]


def corners_beside(placed: PlacedMarkers, board: CharucoBoard) -> RoughCorners:
    """Return the board's corners at the squares of markers that are in place, roughly.

    A corner is predicted by the homography of the nearest markers, one or two, its axes by more of them. Of
    few markers the corners of the squares around are given, too: those of the border have hardly any of their
    own.
    """
    on_board = _on_board(board)[placed.number - board.first_id]
    reach = np.abs(board.indices()[:, None] - on_board.mean(axis=1)).max(axis=2)
    wanted = reach.min(axis=1) < (2.0 if len(placed.number) <= _FEW else 1.0)
    index, reach = board.indices()[wanted], reach[wanted]
    q, axes = np.zeros((len(index), 2)), np.zeros((len(index), 2, 2))
    for n, corner in enumerate(index.astype(np.float64)):
        near, around = (np.flatnonzero(reach[n] < reach[n].min() + more) for more in (0.5, 2.5))
        q[n] = through_markers(placed.corners[near], on_board[near], corner[None], placed.lens)[0]
        steps = corner + 0.5 * np.array([[1, 0], [-1, 0], [0, 1], [0, -1]])
        right, left, up, down = through_markers(placed.corners[around], on_board[around], steps, placed.lens)
        axes[n] = np.stack([right - left, up - down], axis=-1)
    return RoughCorners(index, q, axes, reach.min(axis=1) < 1.0)


def _on_board(board: CharucoBoard) -> Float64[np.ndarray, "n 4 2"]:
    """Return the corners of the board's markers in squares; the board's own (col, row) is at (col, row)."""
    points = np.array(opencv_board(board).getObjPoints(), dtype=np.float64).reshape(-1, 3)
    squares: np.ndarray = board.points_from_opencv(points)[:, :2].reshape(-1, 4, 2) / board.square_mm
    return squares


def _goes_on(
    every: SeenMarkers,
    placed: SeenMarkers,
    lens: RoughUndistortion,
    board: CharucoBoard,
    settings: CornerSettings,
) -> bool:
    """Tell whether a marker is in a square that goes on with the chessboard where the board has ended."""
    on_board = _on_board(board)[placed.number - board.first_id]
    form = on_board[0] - on_board[0].mean(axis=0)
    at = placed.corners.mean(axis=1)
    for corners in every.corners:
        near = np.argsort(np.linalg.norm(at - corners.mean(axis=0), axis=1), kind="stable")[:NEAREST]
        q = lens.undistort(placed.corners[near]).reshape(-1, 2)
        H = projective_map("markers", on_board[near].reshape(-1, 2), q)
        xyw = homogeneous(lens.undistort(corners)) @ np.linalg.pinv(H).T
        seen = xyw[:, :2] / xyw[:, 2:]
        middle = np.floor(seen.mean(axis=0)) + 0.5
        aligned = np.abs(seen - middle - form).max() < settings.max_marker_residual_squares
        square = middle + 0.5  # counted from 0 at the lower left
        if aligned and ((square < 0).any() or (square >= board.squares).any()):
            return True
    return False
