"""Checks of ChArUco boards on drawn pictures: share indexed, wrong ids, errors over the bound, OpenCV's."""

import time

import numpy as np

from labcal.bench.boards.board_checks import board_checks
from labcal.bench.boards.board_outcome import (
    PICTURES,
    QUICK_PICTURES,
    ROUNDING,
    BoardOutcome,
    board_outcome,
    true_corners,
)
from labcal.bench.boards.charuco_ink import charuco_ink
from labcal.bench.boards.charuco_picture import CharucoPicture, charuco_picture
from labcal.bench.boards.corner_bound import ImagedCorner, corner_bounds
from labcal.bench.boards.opencv_charuco import opencv_charuco_corners
from labcal.bench.boards.printed_corner_bound import PrintedCorner, printed_corner_bounds
from labcal.bench.groups import Bench, Findings
from labcal.bench.marks.drawn_picture import INK, PAPER
from labcal.detect.detector import detect_dots
from labcal.rng import generator

BOUNDS = 10
"""Corners of a picture whose bound is computed, drawn at random."""
EDGES = "the squares' edges alone"


def charuco_findings(bench: Bench) -> Findings:
    """Return the checks of ChArUco boards over all difficulties, with OpenCV's on the same pictures."""
    count = QUICK_PICTURES if bench.quick else PICTURES
    bench.progress.start("charuco", count)
    outcomes = []
    for number in range(count):
        picture = charuco_picture(number, bench.seed)
        random = generator(bench.seed, "bench boards", f"charuco corners {number}")
        outcomes.append(charuco_outcome(picture, random))
        bench.progress.advance()
    return board_checks(f"{count} pictures of ChArUco boards", outcomes, EDGES)


def charuco_outcome(picture: CharucoPicture, random: np.random.Generator) -> BoardOutcome:
    """Detect the board of a picture, by labcal and by OpenCV, and compare with the truth.

    Parameters
    ----------
    picture : CharucoPicture
    random : Generator
        Which corners are compared with their bound.
    """
    board, seconds = picture.board, {}
    began = time.perf_counter()
    dots = detect_dots(picture.picture, board)
    seconds["labcal"] = time.perf_counter() - began
    began = time.perf_counter()
    opencv = opencv_charuco_corners(picture.picture, board)
    seconds["OpenCV"] = time.perf_counter() - began
    square = np.array([abs(np.linalg.det(picture.axes(k))) ** 0.5 for k in range(board.count)])
    truth = true_corners(picture, square, board.cols, (lambda k: _bounds(picture, k), BOUNDS))
    return board_outcome(truth, dots, opencv, seconds, random)


def _bounds(picture: CharucoPicture, number: int) -> np.ndarray:
    """Return the least covariances of a corner: by all ink in sight, and by the squares' edges alone."""
    centre, exposure, board = picture.corner[number], picture.exposure, picture.board
    light, axes = float(exposure.light(centre)), picture.axes(number)
    x, y = board.points()[number, :2].tolist()
    print_ = charuco_ink(board)

    def ink(col: np.ndarray, row: np.ndarray) -> np.ndarray:
        return print_(x + board.square_mm * col, y + board.square_mm * row)

    printed = PrintedCorner(
        centre, axes, exposure.blur_px, INK * light, PAPER * light, ink, picture.covers
    )  # fmt: skip
    edges = ImagedCorner(
        centre, axes, exposure.blur_px, INK * light, PAPER * light, clear=board.corner_gap
    )  # fmt: skip
    mean = exposure.noise**2 * light * 0.5 * (INK + PAPER) + ROUNDING
    noises = np.sqrt([[mean, mean]])
    return np.concatenate([printed_corner_bounds(printed, noises), corner_bounds(edges, noises)])
