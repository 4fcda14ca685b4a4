"""Pictures of ChArUco boards that the markers are taken out of: white squares are left."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float64

from labcal.detect.corners.corners import Corners, spans_a_plane
from labcal.detect.grey import GreyPicture
from labcal.geometry.projective_map import homogeneous, projective_map
from labcal.targets.charuco import CharucoBoard
from labcal.targets.charuco_opencv import markers

_NEAR_SQUARES = 2.6
"""Corners up to so far from the middle of a marker tell where it is and how bright."""
_REACH_SIGMAS = 3.5
_SAMPLES_A_BLUR = 5.0
_MOST_SAMPLES = 9
"""Samples along a side of a pixel, an odd number."""
_MOST_CONDITION = 1e10
"""Of a homography, above which its corners are all but on one line."""


@dataclass(frozen=True)
class _Around:
    """The measured corners around a marker: their (col, row), places, and steps from black to white."""

    index: np.ndarray
    q: Float64[np.ndarray, "k 2"]
    step: Float64[np.ndarray, " k"]


def without_markers(grey: GreyPicture, board: CharucoBoard, corners: Corners) -> GreyPicture:
    """Return a picture of the board with plain white squares.

    What the ink of a marker takes from the picture is known: its place by the homography of the corners
    around it, the blur of their edges, and their step from black to white. It is given back. A fit of a
    corner can then count with more pixels beside its edges.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
    board : CharucoBoard
    corners : Corners
        As measured.
    """
    fitted = [k for k, fit in enumerate(corners.fits) if fit is not None]
    if not spans_a_plane(corners.index[fitted]):
        return grey
    fits = [fit for fit in corners.fits if fit is not None]
    index = corners.index[fitted]
    q = np.array([fit.centre for fit in fits])
    steps = np.array([fit.step for fit in fits])
    blur = float(np.sqrt(np.median([0.5 * (fit.state[4] ** 2 + fit.state[5] ** 2) for fit in fits])))
    printed = markers(board)
    plain = grey.copy()
    for corner, black in zip(printed.corner / board.square_mm, printed.is_black, strict=True):
        side = board.marker_mm / board.square_mm
        near = np.abs(index - (corner + 0.5 * side)).max(axis=1) < _NEAR_SQUARES
        if spans_a_plane(index[near]):
            around = _Around(index[near], q[near], steps[near])
            _remove(plain, around, (corner, side, black[::-1].T), blur)
    return plain


def _remove(
    picture: GreyPicture, around: _Around, marker: tuple[np.ndarray, float, np.ndarray], blur: float
) -> None:
    """Give back to a picture, in place, what the ink of a marker takes from it.

    `marker` holds its lower left corner and side, in squares, and which cells are black, by column and row.
    """
    corner, side, black = marker
    H = projective_map("corners", around.index.astype(np.float64), around.q)
    quad = corner + side * np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    seen = homogeneous(quad) @ H.T
    q = seen[:, :2] / seen[:, 2:]
    if (seen[:, 2] * seen[0, 2] <= 0.0).any() or np.linalg.cond(H) > _MOST_CONDITION:
        return
    reach = _REACH_SIGMAS * blur
    low = np.maximum(np.ceil(q.min(axis=0) - reach), 0).astype(int)
    high = np.minimum(np.floor(q.max(axis=0) + reach), np.array(picture.shape[::-1]) - 1).astype(int)
    width, height = (high - low + 1).tolist()
    if width <= 0 or height <= 0:
        return
    samples = min(2 * int(np.ceil(0.5 * _SAMPLES_A_BLUR / blur)) + 1, _MOST_SAMPLES)
    border = int(np.ceil(reach))
    x, y = (
        (np.arange(samples * (n + 2 * border)) - samples // 2) / samples - border + start
        for n, start in ((width, low[0]), (height, low[1]))
    )
    back = np.linalg.inv(H)
    col, row, w = (one[0] * x[None, :] + (one[1] * y + one[2])[:, None] for one in back)
    cells = len(black)
    i, j = (
        np.floor((places / w - start) * cells / side).astype(np.int64)
        for places, start in ((col, corner[0]), (row, corner[1]))
    )
    inside = (i >= 0) & (j >= 0) & (i < cells) & (j < cells)
    ink = np.zeros(inside.shape, dtype=np.float32)
    ink[inside] = black[i[inside], j[inside]]
    soft = cv2.GaussianBlur(ink, (0, 0), blur * samples, borderType=cv2.BORDER_CONSTANT)
    share = soft[border * samples + samples // 2 :: samples, border * samples + samples // 2 :: samples]
    design = np.concatenate([np.ones((len(around.q), 1)), around.q], axis=1)
    plane = np.linalg.lstsq(design, around.step, rcond=None)[0]
    step = (
        plane[0]
        + plane[1] * np.arange(low[0], high[0] + 1)[None]
        + plane[2] * np.arange(low[1], high[1] + 1)[:, None]
    )
    here = picture[low[1] : high[1] + 1, low[0] : high[0] + 1]
    here += (step * share[:height, :width]).astype(picture.dtype)
