"""Duration of detection of chessboards, ChArUco boards and AprilGrids compared with OpenCV's detectors."""

from collections.abc import Callable

import cv2
import numpy as np

from labcal.bench.detect.timing import Times, times_in_turn
from labcal.bench.groups import Findings
from labcal.bench.marks.drawn_picture import tilted
from labcal.detect.detector import detect_dots
from labcal.detect.dots import PictureDots
from labcal.report.bench import Check, Figure, at_most
from labcal.run.threads import one_opencv_thread
from labcal.targets.april_grid import AprilGrid
from labcal.targets.catalogue import AnyTarget, load_target
from labcal.targets.charuco import CharucoBoard
from labcal.targets.charuco_opencv import opencv_board
from labcal.targets.chessboard import Chessboard
from labcal.targets.shapes import printed_outlines

SIZES = ((480, 360), (1280, 960))
BOARDS = ("chessboard-9x6", "charuco-12x9", "aprilgrid-6x6")
LEAST_FOUND = 0.95
"""Of a board's corners, so that a time counts."""
CHESSBOARD_LIMIT = 1.0
PAPER, INK, NOISE, BLUR_PX = 210, 40, 2.5, 0.8
_TILT_DEG, _AZIMUTH, _ROLL = 20.0, 0.6, 0.1
_FOCAL, _FILLED = 1.2, 0.8
"""Focal length over the picture's width; share of the picture's height that the board fills."""
_FINE_BITS = 6
_FINER = 8
"""Drawn at so many times the resolution, without smooth rims: those of two black squares that touch at a
corner darken it, by a tenth of the step, and corners are off by 0.2 px."""


def board_findings(rounds: int, random: np.random.Generator) -> Findings:
    """Return the times of labcal and of OpenCV on one drawn picture of each board in each size.

    Chessboards have a limit: `findChessboardCornersSB` ends with corners as labcal does. `detectBoard` of
    ChArUco and `detectMarkers` of AprilTags do not refine their corners.
    """
    checks: list[Check] = []
    figures: list[Figure] = []
    for name in BOARDS:
        board = load_target(name)
        for size in SIZES:
            picture = drawn_print(board, size, random)
            label = f"speed, {name} at {size[0]} x {size[1]}"
            own, other, found = _times(picture, board, rounds)
            figures += [
                Figure(name=f"{label}: labcal, processor time, s", value=float(own.cpu.min())),
                Figure(name=f"{label}: OpenCV, processor time, s", value=float(other.cpu.min())),
            ]
            short = f"{label}: processor time over that of OpenCV"
            if isinstance(board, Chessboard):
                checks.append(at_most(short, own.over(other) if found else float("nan"), CHESSBOARD_LIMIT))
            else:
                figures.append(Figure(name=short, value=own.over(other) if found else None))
    return Findings(checks, figures)


def _times(picture: np.ndarray, board: AnyTarget, rounds: int) -> tuple[Times, Times, bool]:
    """Return labcal's and OpenCV's times on a picture, and whether both find the board."""
    opencv = _opencv(board)

    def own() -> PictureDots:
        return detect_dots(picture, board)

    def other() -> int:
        return opencv(picture)

    found = own().ok.sum() >= LEAST_FOUND * board.count
    with one_opencv_thread():
        found = bool(found and other() > 0)
        mine, theirs = times_in_turn((own, other), rounds)
    return mine, theirs, found


def _opencv(board: AnyTarget) -> Callable[[np.ndarray], int]:
    """Return a function that finds a board in a picture by OpenCV, and returns the number of its parts."""
    if isinstance(board, Chessboard):
        corners = (board.cols, board.rows)
        return lambda picture: int(cv2.findChessboardCornersSB(picture, corners)[0])
    if isinstance(board, CharucoBoard):
        charuco = cv2.aruco.CharucoDetector(opencv_board(board))

        def seen(picture: np.ndarray) -> int:
            ids = charuco.detectBoard(picture)[1]
            return 0 if ids is None else len(ids)

        return seen
    if not isinstance(board, AprilGrid):
        raise TypeError(f"OpenCV has no detector of {type(board).__name__}")
    tags = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11))
    return lambda picture: len(tags.detectMarkers(picture)[0])


def drawn_print(board: AnyTarget, size: tuple[int, int], random: np.random.Generator) -> np.ndarray:
    """Draw the print of a board, tilted, on white paper before a grey room, with blur and noise, uint8.

    Parameters
    ----------
    board : AnyTarget
    size : (int, int)
        Width and height, px.
    random : numpy.random.Generator
        Of the noise.
    """
    width, height = size
    x_min, y_min, x_max, y_max = board.extent_mm
    focal = _FOCAL * width
    away = focal * max((x_max - x_min) / (_FILLED * width), (y_max - y_min) / (_FILLED * height))
    H = tilted(np.radians(_TILT_DEG), _AZIMUTH, _ROLL, away, focal)
    middle = 0.5 * np.array([x_min + x_max, y_min + y_max])
    corners = np.array([[x_min, y_min], [x_max, y_min], [x_max, y_max], [x_min, y_max]])
    picture = np.full((_FINER * height, _FINER * width), 100, dtype=np.uint8)
    _fill(picture, corners - middle, H, PAPER)
    for part in printed_outlines(board).to_polygons():
        outline = np.asarray(part, dtype=np.float64)
        x, y = outline.T
        is_hole = float(x[:-1] @ y[1:] - y[:-1] @ x[1:]) < 0.0  # it runs the other way round
        _fill(picture, outline - middle, H, PAPER if is_hole else INK)
    mean = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
    blurred = cv2.GaussianBlur(mean.astype(np.float32), (0, 0), BLUR_PX)
    noisy = blurred + NOISE * random.standard_normal(blurred.shape, dtype=np.float32)
    clipped: np.ndarray = np.clip(np.rint(noisy), 0, 255).astype(np.uint8)
    return clipped


def _fill(picture: np.ndarray, outline: np.ndarray, H: np.ndarray, grey: int) -> None:
    """Fill an outline on a print, (n, 2), mm from its middle, which is seen in the fine picture's."""
    height, width = picture.shape
    x, y, w = H @ np.stack([*outline.T, np.ones(len(outline))])
    seen = np.stack([_FINER * x / w + 0.5 * (width - 1), _FINER * y / w + 0.5 * (height - 1)], axis=1)
    corners = np.rint(seen * 2**_FINE_BITS).astype(np.int32)
    cv2.fillPoly(picture, [corners], grey, cv2.LINE_8, _FINE_BITS)
