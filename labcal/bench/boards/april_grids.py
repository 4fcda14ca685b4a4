"""Checks of AprilGrids on drawn pictures: share indexed, wrong ids, errors over the bound, OpenCV's."""

import time

import numpy as np

from labcal.bench.boards.april_grid_picture import AprilGridPicture, april_grid_picture
from labcal.bench.boards.board_checks import board_checks, time_check
from labcal.bench.boards.board_outcome import (
    PICTURES,
    QUICK_PICTURES,
    BoardOutcome,
    board_outcome,
    true_corners,
)
from labcal.bench.boards.chessboards import BOUNDS, WEIGHTED, weighted_noises
from labcal.bench.boards.corner_bound import ImagedTagCorner, corner_bounds
from labcal.bench.boards.opencv_tags import WAYS, opencv_tags
from labcal.bench.groups import Bench, Findings
from labcal.bench.marks.drawn_picture import INK, PAPER
from labcal.detect.detector import detect_dots
from labcal.rng import generator
from labcal.targets.charuco_opencv import opencv_dictionary

MOST_TIME = 2.0
"""Over that of OpenCV, which reads the same tags and fits their corners roughly."""


def april_grid_findings(bench: Bench) -> Findings:
    """Return the checks of AprilGrids over all difficulties, with OpenCV's corners on the same pictures."""
    count = QUICK_PICTURES if bench.quick else PICTURES
    bench.progress.start("april-grids", count)
    outcomes = []
    for number in range(count):
        picture = april_grid_picture(number, bench.seed)
        random = generator(bench.seed, "bench boards", f"corners of april grid {number}")
        outcomes.append(april_grid_outcome(picture, random))
        bench.progress.advance()
    name = f"{count} pictures of AprilGrids"
    found = board_checks(name, outcomes, WEIGHTED)
    return Findings([*found.checks, time_check(name, WAYS[0], outcomes, MOST_TIME)], found.references)


def april_grid_outcome(picture: AprilGridPicture, random: np.random.Generator) -> BoardOutcome:
    """Detect the grid of a picture, by labcal and by OpenCV, and compare with the truth.

    Parameters
    ----------
    picture : AprilGridPicture
    random : Generator
        Which corners are compared with their bound.

    Returns
    -------
    BoardOutcome
        Its times are the processor's: OpenCV may use several threads.
    """
    began = time.process_time()
    dots = detect_dots(picture.picture, picture.board)
    seconds = {"labcal": time.process_time() - began}
    gap = np.array([picture.gap_px(k) for k in range(len(picture.corner))])
    truth = true_corners(picture, gap, picture.board.cols, (lambda k: _bounds(picture, k), BOUNDS))
    opencv = {}
    for way in WAYS:
        began = time.process_time()
        theirs = opencv_tags(picture.picture, picture.board, way)
        seconds[way] = time.process_time() - began
        opencv[way] = truth.nearest(theirs)
    return board_outcome(truth, dots, opencv, seconds, random)


def _bounds(picture: AprilGridPicture, number: int) -> np.ndarray:
    """Return the least covariances of a corner, with the mean variance, and with those of black and white."""
    centre, exposure, grid = picture.corner[number], picture.exposure, picture.board
    light = float(exposure.light(centre))
    cells = opencv_dictionary(grid.dictionary).markerSize + 2 * grid.border_cells
    corner = ImagedTagCorner(
        centre, picture.axes(number), exposure.blur_px, INK * light, PAPER * light,
        gap=grid.tag_spacing, border=grid.border_cells / cells,
    )  # fmt: skip
    return corner_bounds(corner, weighted_noises(exposure.noise, light))
