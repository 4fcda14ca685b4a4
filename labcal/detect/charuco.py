"""From a picture of a ChArUco board to its corners: markers by OpenCV, places by a fit of our own."""

import cv2
import numpy as np

from labcal.detect.corner_fit import CornerFit, Surroundings, fit_corner
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag, Refusal
from labcal.detect.grey import GreyPicture
from labcal.detect.lattice import Lattice
from labcal.detect.noise import noise_factor
from labcal.detect.smoothness import is_smooth
from labcal.targets.charuco import CharucoBoard
from labcal.targets.charuco_opencv import opencv_board
from labcal.targets.grid import Polarity

_SMALLEST_PICTURE = 32  # px
_SMALLEST_MARKER = 12  # px a side
_FEWEST = 4  # corners, not on a line: what a homography takes
_BEND = 0.08  # px times the picture's width: (reach of a fit) squared
_SHADINGS = 1.3  # of a fit's four for the light, spent on the flat parts: a third of its pixels
_ROUGHEST = (2.5, 0.06)  # times the usual roughness of the picture's corners, and of the step


def detect_charuco(grey: GreyPicture, board: CharucoBoard) -> PictureDots:
    """Find the board's corners in one picture.

    A corner is known where OpenCV recognises the markers beside it. Its place is where the two edges cross
    (:func:`labcal.detect.corner_fit.fit_corner`); where the fit fails, the corner is flagged ``bad-fit``.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    board : CharucoBoard
        What to look for.

    Returns
    -------
    PictureDots
        Without outlines. Refused where no marker is recognised, where fewer than four corners, or corners of
        one line only, are measured, and where they lie on no smooth surface.
    """
    size = (grey.shape[1], grey.shape[0])
    rough = _recognised(grey, board)
    if rough is None:
        return _collect(size, np.zeros((0, 2), dtype=np.int64), np.zeros((0, 2)), [], Refusal.NO_MARKERS)
    index, seen_at = rough
    if not _spans_a_plane(index):
        return _collect(size, index, seen_at, [None] * len(index), Refusal.TOO_FEW_DOTS)
    fits = _fitted(grey, board, index, seen_at)
    found = np.flatnonzero([fit is not None for fit in fits])
    if not _spans_a_plane(index[found]):
        return _collect(size, index, seen_at, fits, Refusal.GRID_INCONSISTENT)
    places = np.array([seen_at[k] if (fit := fits[k]) is None else fit.centre for k in range(len(fits))])
    lattice = Lattice({(int(index[k, 0]), int(index[k, 1])): int(k) for k in found})
    smooth = is_smooth(lattice, places)
    return _collect(size, index, seen_at, fits, None if smooth else Refusal.GRID_INCONSISTENT)


def _recognised(grey: GreyPicture, board: CharucoBoard) -> tuple[np.ndarray, np.ndarray] | None:
    """Return (col, row) and rough places of the corners that OpenCV knows by their markers, if any."""
    if min(grey.shape) < _SMALLEST_PICTURE:
        return None
    low, high = np.percentile(grey, [0.1, 99.9])
    if high <= low:
        return None
    bytes_ = np.clip((grey - low) * (255.0 / (high - low)), 0, 255).astype(np.uint8)
    parameters = cv2.aruco.DetectorParameters()
    parameters.minMarkerPerimeterRate = min(0.03, 4.0 * _SMALLEST_MARKER / max(grey.shape))
    detector = cv2.aruco.CharucoDetector(opencv_board(board), detectorParams=parameters)
    corners, ids, _, marker_ids = detector.detectBoard(bytes_)
    if marker_ids is None or len(marker_ids) == 0:
        return None
    if ids is None:
        return np.zeros((0, 2), dtype=np.int64), np.zeros((0, 2))
    index = board.from_opencv(np.asarray(ids, dtype=np.int64).ravel())
    order = np.lexsort((index[:, 0], index[:, 1]))
    return index[order], np.asarray(corners, dtype=np.float64).reshape(-1, 2)[order]


def _spans_a_plane(index: np.ndarray) -> bool:
    """Tell whether there are corners enough, and not all on one line."""
    if len(index) < _FEWEST:
        return False
    return int(np.linalg.matrix_rank(index - index[0])) > 1


def _fitted(
    grey: GreyPicture, board: CharucoBoard, index: np.ndarray, seen_at: np.ndarray
) -> list[CornerFit | None]:
    """Fit every corner; what is much rougher than the rest is no corner."""
    axes = _axes(index, seen_at)
    reach = max(5.0, float(np.sqrt(_BEND * max(grey.shape))))
    gap = 0.5 * (1.0 - board.marker_mm / board.square_mm)
    white = np.where(board.is_black(index[:, 0] + 1, index[:, 1] + 1), -1, 1)
    fits = [
        fit_corner(grey, Surroundings(seen_at[k], axes[k], int(white[k]), gap, reach))
        for k in range(len(index))
    ]
    usual = float(np.median([fit.roughness for fit in fits if fit is not None] or [0.0]))
    roughest = _ROUGHEST[0] * usual + _ROUGHEST[1]
    return [None if fit is None or fit.roughness > roughest else fit for fit in fits]


def _axes(index: np.ndarray, seen_at: np.ndarray) -> np.ndarray:
    """Return one square along x and y at every corner, px, from the homography of all; (n, 2, 2)."""
    H, _ = cv2.findHomography(index.astype(np.float64), seen_at)
    xyw = np.concatenate([index, np.ones((len(index), 1))], axis=1) @ np.asarray(H).T
    q, w = xyw[:, :2] / xyw[:, 2:], xyw[:, 2]
    axes: np.ndarray = (H[None, :2, :2] - q[:, :, None] * H[None, 2:, :2]) / w[:, None, None]
    return axes


def _collect(
    size: tuple[int, int],
    index: np.ndarray,
    seen_at: np.ndarray,
    fits: list[CornerFit | None],
    refusal: Refusal | None,
) -> PictureDots:
    """Put the corners into arrays."""
    n = len(index)
    factor = noise_factor([fit.scatter for fit in fits if fit is not None], _SHADINGS)
    dots = PictureDots(
        size=size,
        polarity=Polarity.BLACK_ON_WHITE,
        refusal=None,
        index=index,
        has_id=np.ones(n, dtype=bool),
        position=np.array([[np.nan] * 2 if fit is None else fit.centre for fit in fits]).reshape(-1, 2),
        covariance=np.array(
            [np.full((2, 2), np.nan) if fit is None else factor * fit.covariance for fit in fits]
        ).reshape(-1, 2, 2),
        flag=tuple(DotFlag.BAD_FIT if fit is None else DotFlag.OK for fit in fits),
        seen_at=seen_at,
        outline=np.full((n, 2, 2), np.nan),
    )
    return dots if refusal is None else dots.refused(refusal)
