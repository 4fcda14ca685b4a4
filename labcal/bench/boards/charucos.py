"""Checks of ChArUco boards on drawn pictures: share indexed, wrong ids, errors over the bound, OpenCV's."""

import time
from dataclasses import dataclass

import numpy as np

from labcal.bench.boards.charuco_ink import charuco_ink
from labcal.bench.boards.charuco_picture import CharucoPicture, charuco_picture
from labcal.bench.boards.corner_bound import ImagedCorner, corner_bounds
from labcal.bench.boards.opencv_charuco import WAYS, opencv_charuco_corners
from labcal.bench.boards.printed_corner_bound import PrintedCorner, printed_corner_bounds
from labcal.bench.detect.accuracy import SIGMAS, chi_square_z, over_bound
from labcal.bench.groups import Bench, Findings
from labcal.bench.marks.drawn_picture import INK, PAPER
from labcal.detect.detector import detect_dots
from labcal.report.bench import Check, Figure, at_most
from labcal.rng import generator

PICTURES, QUICK_PICTURES = 200, 16
MOST_NOT_INDEXED = 0.01
MOST_RATIO = 1.2
MOST_OF_OPENCV = 0.5
OFF_SQUARES = 0.25
"""Error above which the id of a measured corner counts as wrong, in squares."""
BOUNDS = 10
"""Corners of a picture whose bound is computed, drawn at random."""
ROUNDING = 1.0 / 12.0 / 255.0**2
"""Variance of rounding to whole levels, as a share of full scale squared."""


@dataclass(frozen=True)
class CharucoOutcome:
    """Comparison of one picture's corners with the truth.

    Attributes
    ----------
    indexed : bool
    wrong : int
        Measured corners that are not where the corner of their id is.
    missed : int
        Corners in sight that are not measured.
    error : ndarray, shape (m, 2)
        Measured minus true places of corners in sight, as many as have a bound, px.
    covariance : ndarray, shape (m, 2, 2)
        As stated, px squared.
    bound, edge_bound : ndarray, shape (m, 2, 2)
        The least covariance possible where all ink around the corner tells of its place; and where only the
        edges of the squares do, and no pixel that shows a marker counts.
    opencv, own : dict of str to ndarray, shape (k, 2)
        Errors of OpenCV's corners, by way, and of labcal's on the same corners, px.
    seconds : dict of str to float
        Time of labcal, and of OpenCV.
    """

    indexed: bool
    wrong: int
    missed: int
    error: np.ndarray
    covariance: np.ndarray
    bound: np.ndarray
    edge_bound: np.ndarray
    opencv: dict[str, np.ndarray]
    own: dict[str, np.ndarray]
    seconds: dict[str, float]


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
    return charuco_checks(f"{count} pictures of ChArUco boards", outcomes)


def charuco_outcome(picture: CharucoPicture, random: np.random.Generator) -> CharucoOutcome:
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
    place, covariance = np.full((board.count, 2), np.nan), np.full((board.count, 2, 2), np.nan)
    if dots.indexed:
        number = dots.index[dots.ok, 1] * board.cols + dots.index[dots.ok, 0]
        place[number], covariance[number] = dots.position[dots.ok], dots.covariance[dots.ok]
    off = place - picture.corner
    measured = np.isfinite(off).all(axis=1)
    square = np.array([abs(np.linalg.det(picture.axes(k))) ** 0.5 for k in range(len(off))])
    some = np.sort(random.permutation(np.flatnonzero(measured & picture.visible))[:BOUNDS])
    bounds = np.array([_bounds(picture, k) for k in some.tolist()]).reshape(-1, 2, 2, 2)
    began = time.perf_counter()
    found = opencv_charuco_corners(picture.picture, board)
    seconds["OpenCV"] = time.perf_counter() - began
    opencv, own = {}, {}
    for way, theirs in found.items():
        error = theirs - picture.corner
        # Of OpenCV's corners those count that are in sight and near the true ones.
        with np.errstate(invalid="ignore"):
            both = measured & picture.visible & (np.linalg.norm(error, axis=1) < OFF_SQUARES * square)
        opencv[way], own[way] = error[both], off[both]
    return CharucoOutcome(
        indexed=dots.indexed,
        wrong=int((np.linalg.norm(off[measured], axis=1) > OFF_SQUARES * square[measured]).sum()),
        missed=int((picture.visible & ~measured).sum()),
        error=off[some],
        covariance=covariance[some],
        bound=bounds[:, 0],
        edge_bound=bounds[:, 1],
        opencv=opencv,
        own=own,
        seconds=seconds,
    )


def charuco_checks(name: str, outcomes: list[CharucoOutcome]) -> Findings:
    """Return the checks of pictures of ChArUco boards.

    Parameters
    ----------
    name : str
    outcomes : list of CharucoOutcome
    """
    error, covariance, bound, edge_bound = (
        np.concatenate([getattr(one, part) for one in outcomes])
        for part in ("error", "covariance", "bound", "edge_bound")
    )
    squares = np.einsum("ni,ni->n", error, np.linalg.solve(covariance, error[..., None])[..., 0])
    checks = [
        at_most(
            f"{name}: share not indexed",
            1.0 - float(np.mean([o.indexed for o in outcomes])),
            MOST_NOT_INDEXED,
        ),
        at_most(f"{name}: wrong ids", float(sum(one.wrong for one in outcomes)), 0.0),
        at_most(f"{name}: RMS error over the Cramer-Rao bound", over_bound(error, bound), MOST_RATIO),
        at_most(
            f"{name}: normalised errors off chi-square, standard deviations",
            abs(chi_square_z(float(squares.sum()), 2 * len(error))),
            SIGMAS,
        ),
    ]
    figures = [
        Figure(name=f"{name}: corners compared with the bound", value=float(len(error))),
        Figure(
            name=f"{name}: corners in sight not measured, a picture",
            value=_mean([float(one.missed) for one in outcomes if one.indexed]),
        ),
        Figure(name=f"{name}: RMS error over what is stated", value=over_bound(error, covariance)),
        Figure(
            name=f"{name}: RMS error over the bound of the squares' edges alone",
            value=over_bound(error, edge_bound),
        ),
    ]
    for who in ("labcal", "OpenCV"):
        seconds = float(np.median([one.seconds[who] for one in outcomes]))
        figures.append(Figure(name=f"{name}: {who}, median s", value=seconds))
    for way in WAYS:
        more_checks, more_figures = _beside(name, way, outcomes)
        checks += more_checks
        figures += more_figures
    return Findings(checks, figures)


def _beside(name: str, way: str, outcomes: list[CharucoOutcome]) -> tuple[list[Check], list[Figure]]:
    """Return the check and the figures beside one of OpenCV's ways."""
    theirs, ours = (
        np.concatenate([getattr(one, part)[way] for one in outcomes]) for part in ("opencv", "own")
    )
    found = _mean([float(len(one.opencv[way]) > 0) for one in outcomes])
    return [at_most(f"{name}: RMS error over that of {way}", _rms(ours) / _rms(theirs), MOST_OF_OPENCV)], [
        Figure(name=f"{name}: share in which {way} finds corners", value=found),
        Figure(name=f"{name}: {way}, RMS error, px", value=_rms(theirs)),
        Figure(name=f"{name}: labcal on the same corners, RMS error, px", value=_rms(ours)),
    ]


def _bounds(picture: CharucoPicture, number: int) -> np.ndarray:
    """Return the least covariances of a corner: by all ink, and by the edges of the squares alone."""
    centre, exposure, board = picture.corner[number], picture.exposure, picture.board
    light, axes = float(exposure.light(centre)), picture.axes(number)
    x, y = board.points()[number, :2].tolist()
    print_ = charuco_ink(board)

    def ink(col: np.ndarray, row: np.ndarray) -> np.ndarray:
        return print_(x + board.square_mm * col, y + board.square_mm * row)

    printed = PrintedCorner(centre, axes, exposure.blur_px, INK * light, PAPER * light, ink)
    edges = ImagedCorner(
        centre, axes, exposure.blur_px, INK * light, PAPER * light, clear=board.corner_gap
    )  # fmt: skip
    mean = exposure.noise**2 * light * 0.5 * (INK + PAPER) + ROUNDING
    noises = np.sqrt([[mean, mean]])
    return np.concatenate([printed_corner_bounds(printed, noises), corner_bounds(edges, noises)])


def _rms(errors: np.ndarray) -> float:
    return float(np.sqrt((errors**2).sum(axis=1).mean())) if len(errors) else float("nan")


def _mean(values: list[float]) -> float:
    return float(np.mean(values)) if values else float("nan")
