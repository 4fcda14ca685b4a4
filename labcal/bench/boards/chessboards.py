"""Checks of chessboards on drawn pictures: share indexed, wrong ids, errors over the bound, OpenCV's."""

import time

import numpy as np

from labcal.bench.boards.board_checks import board_checks, time_check
from labcal.bench.boards.board_outcome import (
    PICTURES,
    QUICK_PICTURES,
    ROUNDING,
    BoardOutcome,
    board_outcome,
    true_corners,
)
from labcal.bench.boards.chessboard_picture import ChessboardPicture, chessboard_picture
from labcal.bench.boards.corner_bound import ImagedCorner, corner_bounds
from labcal.bench.boards.opencv_corners import WAYS, opencv_corners
from labcal.bench.groups import Bench, Findings
from labcal.bench.marks.drawn_picture import INK, PAPER
from labcal.detect.detector import detect_dots
from labcal.rng import generator

MOST_TIME = 1.0
BOUNDS = 20
"""Corners of a picture whose bound is computed, drawn at random."""
WEIGHTED = "a fit that weights pixels by their noise"


def chessboard_findings(bench: Bench) -> Findings:
    """Return the checks of chessboards over all difficulties, with OpenCV's corners on the same pictures."""
    count = QUICK_PICTURES if bench.quick else PICTURES
    bench.progress.start("chessboards", count)
    outcomes = []
    for number in range(count):
        picture = chessboard_picture(number, bench.seed)
        random = generator(bench.seed, "bench boards", f"corners {number}")
        outcomes.append(chessboard_outcome(picture, random))
        bench.progress.advance()
    name = f"{count} pictures of chessboards"
    found = board_checks(name, outcomes, WEIGHTED)
    return Findings([*found.checks, time_check(name, WAYS[0], outcomes, MOST_TIME)], found.references)


def chessboard_outcome(picture: ChessboardPicture, random: np.random.Generator) -> BoardOutcome:
    """Detect the board of a picture, by labcal and by OpenCV, and compare with the truth.

    Parameters
    ----------
    picture : ChessboardPicture
    random : Generator
        Which corners are compared with their bound.
    """
    began = time.perf_counter()
    dots = detect_dots(picture.picture, picture.board)
    seconds = {"labcal": time.perf_counter() - began}
    square = np.array([abs(np.linalg.det(picture.axes(k))) ** 0.5 for k in range(len(picture.corner))])
    truth = true_corners(picture, square, picture.board.cols, (lambda k: _bounds(picture, k), BOUNDS))
    opencv = {}
    for way in WAYS:
        began = time.perf_counter()
        theirs = opencv_corners(picture.picture, picture.board, way)
        seconds[way] = time.perf_counter() - began
        opencv[way] = truth.nearest(theirs)
    return board_outcome(truth, dots, opencv, seconds, random)


def _bounds(picture: ChessboardPicture, number: int) -> np.ndarray:
    """Return the least covariances of a corner, with the mean variance, and with those of black and white."""
    centre, exposure = picture.corner[number], picture.exposure
    light = float(exposure.light(centre))
    row, col = divmod(number, picture.board.cols)
    corner = ImagedCorner(
        centre, picture.axes(number), exposure.blur_px, INK * light, PAPER * light,
        mark=0.5 - picture.board.clear_reach(col, row),
    )  # fmt: skip
    return corner_bounds(corner, weighted_noises(exposure.noise, light))


def weighted_noises(noise: float, light: float) -> np.ndarray:
    """Return the noise of ink and paper, if it were the mean one, and as it is; shape (2, 2)."""
    ink, paper = (noise**2 * light * level + ROUNDING for level in (INK, PAPER))
    mean = 0.5 * (ink + paper)
    return np.sqrt([[mean, mean], [ink, paper]])
