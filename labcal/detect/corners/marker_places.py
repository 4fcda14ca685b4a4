"""The markers of a board that are in the places where the board has them, and the corners beside them."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float64, Int64

from labcal.arrays import DotIndices, Pixels
from labcal.detect.stage_settings.corner import CornerSettings
from labcal.geometry.projective_map import homogeneous, projective_map, robust_homography
from labcal.targets.charuco import CharucoBoard
from labcal.targets.charuco_opencv import opencv_board, opencv_dictionary

_LEAST_AGREEING = 2
"""Markers: a single one is in place on any board of its dictionary."""
_SEEDS = 12
"""Markers with which the search for those that agree begins, spread over those that are seen."""
_FEW = 3
"""Markers in place, up to which corners further away are begun with."""
_NEAREST = 3
"""Markers in place that predict the next one."""
_LEAST_APART = 4
"""Markers that one homography takes to their places, and that are too far apart to predict each other."""
_APART = 0.6
"""Of the distance from its place that a marker may have beside others: here it is all the evidence."""


@dataclass(frozen=True)
class SeenMarkers:
    """Markers of a board's dictionary that are read in a picture.

    Attributes
    ----------
    number : ndarray of int, shape (n,)
        Their ids in the dictionary.
    corners : ndarray, shape (n, 4, 2)
        Where their corners are, px, in OpenCV's order: clockwise from the upper left one.
    """

    number: Int64[np.ndarray, " n"]
    corners: Float64[np.ndarray, "n 4 2"]

    @classmethod
    def none(cls) -> "SeenMarkers":
        """Return no markers."""
        return cls(np.zeros(0, dtype=np.int64), np.zeros((0, 4, 2)))

    def select(self, which: Int64[np.ndarray, " m"]) -> "SeenMarkers":
        """Return some of them."""
        return SeenMarkers(self.number[which], self.corners[which])

    def on(self, board: CharucoBoard) -> "SeenMarkers":
        """Return those whose ids the board has."""
        own = (self.number >= board.first_id) & (self.number < board.first_id + board.marker_count)
        return self.select(np.flatnonzero(own))


def seen_markers(picture: np.ndarray, board: CharucoBoard, settings: CornerSettings) -> SeenMarkers:
    """Read the markers of the board's dictionary in a picture.

    Parameters
    ----------
    picture : ndarray of uint8, shape (h, w)
    board : CharucoBoard
        Its dictionary counts alone: the ids may be of another board.
    settings : CornerSettings
    """
    parameters = cv2.aruco.DetectorParameters()
    parameters.minMarkerPerimeterRate = min(0.03, 4.0 * settings.min_marker_px / max(picture.shape))
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    detector = cv2.aruco.ArucoDetector(opencv_dictionary(board.dictionary), parameters)
    corners, number, _ = detector.detectMarkers(picture)
    if number is None:
        return SeenMarkers.none()
    return SeenMarkers(
        np.asarray(number, dtype=np.int64).ravel(), np.asarray(corners, dtype=np.float64).reshape(-1, 4, 2)
    )


def markers_in_place(seen: SeenMarkers, board: CharucoBoard, settings: CornerSettings) -> SeenMarkers:
    """Return the markers that are where the board has them, as seen from one another; none on another board.

    From one marker on, the next nearest one must be where its nearest neighbours in place predict it, by the
    homography of their corners, which a lens bends little from one square to the next. The largest such set
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
    """
    every, seen = seen, seen.on(board)
    on_board = _on_board(board)[seen.number - board.first_id]
    best = markers_that_agree(seen, on_board, settings.max_marker_residual_squares)
    placed = seen.select(np.array(sorted(best), dtype=np.int64))
    if best and _goes_on(every, placed, board, settings):
        return SeenMarkers.none()
    return placed


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


def corners_beside(placed: SeenMarkers, board: CharucoBoard) -> RoughCorners:
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
        q[n] = through_markers(placed.corners[near], on_board[near], corner[None])[0]
        steps = corner + 0.5 * np.array([[1, 0], [-1, 0], [0, 1], [0, -1]])
        right, left, up, down = through_markers(placed.corners[around], on_board[around], steps)
        axes[n] = np.stack([right - left, up - down], axis=-1)
    return RoughCorners(index, q, axes, reach.min(axis=1) < 1.0)


def _on_board(board: CharucoBoard) -> Float64[np.ndarray, "n 4 2"]:
    """Return the corners of the board's markers in squares; the board's own (col, row) is at (col, row)."""
    points = np.array(opencv_board(board).getObjPoints(), dtype=np.float64).reshape(-1, 3)
    squares: np.ndarray = board.points_from_opencv(points)[:, :2].reshape(-1, 4, 2) / board.square_mm
    return squares


def through_markers(
    q: Float64[np.ndarray, "k 4 2"],
    on_board: Float64[np.ndarray, "k 4 2"],
    wanted: Float64[np.ndarray, "n 2"],
) -> Float64[np.ndarray, "n 2"]:
    """Return where points of the board (squares) are seen, by the homography of some markers, px."""
    H = projective_map("markers", on_board.reshape(-1, 2), q.reshape(-1, 2))
    xyw = homogeneous(wanted) @ H.T
    seen: np.ndarray = xyw[:, :2] / xyw[:, 2:]
    return seen


def _nearest(placed: list[int], k: int, at: Float64[np.ndarray, "n 2"]) -> list[int]:
    """Return the few markers in place that are nearest to one."""
    away = np.hypot(*(at[placed] - at[k]).T)
    return [placed[one] for one in np.argsort(away, kind="stable")[:_NEAREST]]


def _goes_on(every: SeenMarkers, placed: SeenMarkers, board: CharucoBoard, settings: CornerSettings) -> bool:
    """Tell whether a marker is in a square that goes on with the chessboard where the board has ended."""
    on_board = _on_board(board)[placed.number - board.first_id]
    form = on_board[0] - on_board[0].mean(axis=0)
    at = placed.corners.mean(axis=1)
    for corners in every.corners:
        near = np.argsort(np.linalg.norm(at - corners.mean(axis=0), axis=1), kind="stable")[:_NEAREST]
        H = projective_map("markers", on_board[near].reshape(-1, 2), placed.corners[near].reshape(-1, 2))
        xyw = homogeneous(corners) @ np.linalg.pinv(H).T
        seen = xyw[:, :2] / xyw[:, 2:]
        middle = np.floor(seen.mean(axis=0)) + 0.5
        aligned = np.abs(seen - middle - form).max() < settings.max_marker_residual_squares
        square = middle + 0.5  # counted from 0 at the lower left
        if aligned and ((square < 0).any() or (square >= board.squares).any()):
            return True
    return False


def markers_that_agree(
    seen: SeenMarkers, on_board: Float64[np.ndarray, "n 4 2"], limit_squares: float
) -> list[int]:
    """Return the largest set of markers that agree, by number in `seen`; none where that is no evidence.

    Evidence are two markers or more, and at least half of the ids.
    """
    best: list[int] = []
    if len(seen.number):
        for seed in sorted(set(np.linspace(0, len(seen.number) - 1, _SEEDS).astype(int).tolist())):
            if seed not in best:
                best = max(best, _agreeing(seed, seen, on_board, limit_squares), key=len)
    ids = len(np.unique(seen.number))
    if len(best) >= _LEAST_AGREEING and 2 * len(best) >= ids:
        return best
    best = _on_one_plane(seen, on_board, _APART * limit_squares) if ids >= _LEAST_APART else []
    return best if 2 * len(best) >= ids else []


def _on_one_plane(
    seen: SeenMarkers, on_board: Float64[np.ndarray, "n 4 2"], limit_squares: float
) -> list[int]:
    """Return the markers that one homography takes to their places, by number; none of fewer than four.

    They may be far from each other, which those are not that are predicted from one another.
    """
    H = robust_homography(on_board.reshape(-1, 2), seen.corners.reshape(-1, 2))
    if H is None:
        return []
    xyw = homogeneous(on_board.reshape(-1, 2)) @ H.T
    off = (xyw[:, :2] / xyw[:, 2:]).reshape(-1, 4, 2) - seen.corners
    sides = np.linalg.norm(seen.corners - np.roll(seen.corners, 1, axis=1), axis=2).mean(axis=1)
    squares = sides / np.linalg.norm(on_board[:, 0] - on_board[:, 1], axis=1)
    near = np.flatnonzero(np.abs(off).max(axis=(1, 2)) < limit_squares * squares).tolist()
    once = list({int(seen.number[k]): k for k in reversed(near)}.values())
    return once if len(once) >= _LEAST_APART else []


def _agreeing(
    seed: int, seen: SeenMarkers, on_board: Float64[np.ndarray, "n 4 2"], limit_squares: float
) -> list[int]:
    """Return the markers that agree with one, by number in `seen`; of one id the first that does."""
    centre = on_board.mean(axis=1)
    placed, taken = [seed], {int(seen.number[seed])}
    distance = np.hypot(*(centre - centre[seed]).T)
    left = {k for k in range(len(centre)) if k != seed}
    while left:
        k = min(left, key=lambda one: (distance[one], one))
        left.remove(k)
        if int(seen.number[k]) in taken:
            continue
        near = _nearest(placed, k, centre)
        predicted = through_markers(seen.corners[near], on_board[near], on_board[k])
        side = np.linalg.norm(seen.corners[k] - np.roll(seen.corners[k], 1, axis=0), axis=1).mean()
        square = side / np.linalg.norm(on_board[k, 0] - on_board[k, 1])
        if np.abs(predicted - seen.corners[k]).max() > limit_squares * square:
            continue
        placed.append(k)
        taken.add(int(seen.number[k]))
        distance = np.minimum(distance, np.hypot(*(centre - centre[k]).T))
    return placed
