"""Checks of AprilGrids on drawn pictures: share indexed, wrong ids, errors over the bound, OpenCV's."""

import time

import numpy as np

from labcal.bench.boards.april_grid_picture import AprilGridPicture, april_grid_picture
from labcal.bench.boards.chessboards import (
    BOUNDS,
    OFF_SQUARES,
    PICTURES,
    QUICK_PICTURES,
    ROUNDING,
    BoardOutcome,
    chessboard_checks,
)
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
    return chessboard_checks(f"{count} pictures of AprilGrids", outcomes, MOST_TIME)


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
    place, covariance = np.full(picture.corner.shape, np.nan), np.full((len(picture.corner), 2, 2), np.nan)
    number = dots.index[dots.ok, 1] * picture.board.cols + dots.index[dots.ok, 0]
    place[number], covariance[number] = dots.position[dots.ok], dots.covariance[dots.ok]
    off = place - picture.corner
    measured = np.isfinite(off).all(axis=1)
    near = OFF_SQUARES * np.array([picture.gap_px(k) for k in range(len(off))])
    seen = np.flatnonzero(measured & picture.visible)
    some = np.sort(random.permutation(seen)[:BOUNDS])
    bounds = np.array([_bounds(picture, k) for k in some.tolist()]).reshape(-1, 2, 2, 2)
    opencv, own = {}, {}
    for way in WAYS:
        began = time.process_time()
        theirs = opencv_tags(picture.picture, picture.board, way)
        seconds[way] = time.process_time() - began
        nearest = _nearest(theirs, picture, near)
        both = np.isfinite(nearest).all(axis=1) & measured & picture.visible
        opencv[way], own[way] = nearest[both] - picture.corner[both], off[both]
    return BoardOutcome(
        indexed=dots.indexed,
        wrong=int((measured & (np.linalg.norm(off, axis=1) > near)).sum()),
        missed=int((picture.visible & ~measured).sum()),
        error=off[some],
        covariance=covariance[some],
        bound=bounds[:, 0],
        sharper_bound=bounds[:, 1],
        opencv=opencv,
        own=own,
        seconds=seconds,
    )


def _nearest(corners: np.ndarray, picture: AprilGridPicture, near: np.ndarray) -> np.ndarray:
    """Return the found corner nearest to each true one, up to so far away (n,), px; NaN where none is."""
    found = np.full((len(picture.corner), 2), np.nan)
    if len(corners):
        away = np.linalg.norm(picture.corner[:, None] - corners[None], axis=-1)
        some = away.min(axis=1) < near
        found[some] = corners[away.argmin(axis=1)[some]]
    return found


def _bounds(picture: AprilGridPicture, number: int) -> np.ndarray:
    """Return the least covariances of a corner, with the mean variance, and with those of black and white."""
    centre, exposure, grid = picture.corner[number], picture.exposure, picture.board
    light = float(exposure.light(centre))
    cells = opencv_dictionary(grid.dictionary).markerSize + 2 * grid.border_cells
    corner = ImagedTagCorner(
        centre, picture.axes(number), exposure.blur_px, INK * light, PAPER * light,
        gap=grid.tag_spacing, border=grid.border_cells / cells,
    )  # fmt: skip
    ink, paper = (exposure.noise**2 * light * level + ROUNDING for level in (INK, PAPER))
    mean = 0.5 * (ink + paper)
    return corner_bounds(corner, np.sqrt([[mean, mean], [ink, paper]]))
