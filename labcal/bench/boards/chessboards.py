"""Checks of chessboards on drawn pictures: share indexed, wrong ids, errors over the bound, OpenCV's."""

import time
from dataclasses import dataclass

import numpy as np

from labcal.bench.boards.chessboard_picture import ChessboardPicture, chessboard_picture
from labcal.bench.boards.corner_bound import ImagedCorner, corner_bounds
from labcal.bench.boards.opencv_corners import WAYS, opencv_corners
from labcal.bench.detect.accuracy import SIGMAS, chi_square_z, over_bound
from labcal.bench.groups import Bench, Findings
from labcal.bench.marks.drawn_picture import INK, PAPER
from labcal.detect.detector import detect_dots
from labcal.detect.dots import PictureDots
from labcal.report.bench import Figure, at_most
from labcal.rng import generator

PICTURES, QUICK_PICTURES = 200, 16
MOST_NOT_INDEXED = 0.01
MOST_RATIO = 1.2
MOST_OF_OPENCV = 0.5
MOST_TIME = 1.0
OFF_SQUARES = 0.25
"""Error above which the id of a measured corner counts as wrong, in squares."""
BOUNDS = 20
"""Corners of a picture whose bound is computed, drawn at random."""
ROUNDING = 1.0 / 12.0 / 255.0**2
"""Variance of rounding to whole levels, as a share of full scale squared."""


@dataclass(frozen=True)
class BoardOutcome:
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
    bound, sharper_bound : ndarray, shape (m, 2, 2)
        The least covariance possible if all pixels had the mean variance of black and white; and with the
        noise as it is.
    opencv : dict of str to ndarray, shape (k, 2)
        Errors of OpenCV's corners, by way, px; none where it finds no board.
    own : dict of str to ndarray, shape (k, 2)
        Errors of labcal's on the same corners.
    seconds : dict of str to float
        Time of each way, labcal's by the name "labcal".
    """

    indexed: bool
    wrong: int
    missed: int
    error: np.ndarray
    covariance: np.ndarray
    bound: np.ndarray
    sharper_bound: np.ndarray
    opencv: dict[str, np.ndarray]
    own: dict[str, np.ndarray]
    seconds: dict[str, float]


def chessboard_findings(bench: Bench) -> Findings:
    """Return the checks of chessboards over all difficulties, with OpenCV's corners on the same pictures."""
    count = QUICK_PICTURES if bench.quick else PICTURES
    bench.progress.start("chessboards", count)
    outcomes = []
    for number in range(count):
        picture = chessboard_picture(number, bench.seed)
        outcomes.append(board_outcome(picture, generator(bench.seed, "bench boards", f"corners {number}")))
        bench.progress.advance()
    return chessboard_checks(f"{count} pictures of chessboards", outcomes)


def board_outcome(picture: ChessboardPicture, random: np.random.Generator) -> BoardOutcome:
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
    place, covariance = _by_corner(dots, picture)
    off = place - picture.corner
    measured = np.isfinite(off).all(axis=1)
    square = np.array([abs(np.linalg.det(picture.axes(k))) ** 0.5 for k in range(len(off))])
    wrong = measured & (np.linalg.norm(off, axis=1) > OFF_SQUARES * square)
    seen = np.flatnonzero(measured & picture.visible)
    some = np.sort(random.permutation(seen)[:BOUNDS])
    bounds = np.array([_bounds(picture, k) for k in some.tolist()]).reshape(-1, 2, 2, 2)
    opencv, own = {}, {}
    for way in WAYS:
        began = time.perf_counter()
        theirs = opencv_corners(picture.picture, picture.board, way)
        seconds[way] = time.perf_counter() - began
        nearest = _nearest(theirs, picture, square)
        both = np.isfinite(nearest).all(axis=1) & measured & picture.visible
        opencv[way], own[way] = nearest[both] - picture.corner[both], off[both]
    return BoardOutcome(
        indexed=dots.indexed,
        wrong=int(wrong.sum()),
        missed=int((picture.visible & ~measured).sum()),
        error=off[some],
        covariance=covariance[some],
        bound=bounds[:, 0],
        sharper_bound=bounds[:, 1],
        opencv=opencv,
        own=own,
        seconds=seconds,
    )


def chessboard_checks(name: str, outcomes: list[BoardOutcome], most_time: float = MOST_TIME) -> Findings:
    """Return the checks of pictures of chessboards.

    Parameters
    ----------
    name : str
    outcomes : list of BoardOutcome
        At least one, all with the same ways of OpenCV.
    most_time : float
        Over that of OpenCV's first way.
    """
    ways = tuple(outcomes[0].opencv)
    error, covariance, bound, sharper = (
        np.concatenate([getattr(one, part) for one in outcomes])
        for part in ("error", "covariance", "bound", "sharper_bound")
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
            value=float(np.mean([float(one.missed) for one in outcomes if one.indexed] or [float("nan")])),
        ),
        Figure(name=f"{name}: RMS error over what is stated", value=over_bound(error, covariance)),
        Figure(
            name=f"{name}: RMS error over the bound of a fit that weights pixels by their noise",
            value=over_bound(error, sharper),
        ),
        Figure(name=f"{name}: labcal, median s", value=_median([one.seconds["labcal"] for one in outcomes])),
    ]
    for way in ways:
        theirs, ours = (
            np.concatenate([getattr(one, part)[way] for one in outcomes]) for part in ("opencv", "own")
        )
        if len(theirs):
            checks.append(
                at_most(f"{name}: RMS error over that of {way}", _rms(ours) / _rms(theirs), MOST_OF_OPENCV)
            )
        found = np.mean([len(one.opencv[way]) > 0 for one in outcomes])
        figures.append(Figure(name=f"{name}: share in which {way} finds the board", value=float(found)))
        figures.append(Figure(name=f"{name}: {way}, RMS error, px", value=_rms(theirs)))
        figures.append(Figure(name=f"{name}: labcal on the same corners, RMS error, px", value=_rms(ours)))
        figures.append(
            Figure(name=f"{name}: {way}, median s", value=_median([o.seconds[way] for o in outcomes]))
        )
    fast = [one.seconds["labcal"] / one.seconds[ways[0]] for one in outcomes if len(one.opencv[ways[0]])]
    checks.append(at_most(f"{name}: time over that of {ways[0]}", _median(fast), most_time))
    return Findings(checks, figures)


def _by_corner(dots: PictureDots, picture: ChessboardPicture) -> tuple[np.ndarray, np.ndarray]:
    """Return measured places and covariances by corner, NaN where there is none.

    Of numberings that fit the picture as well, a board's own symmetries, that one counts which is true.
    """
    count, cols = picture.board.count, picture.board.cols
    place, covariance = np.full((count, 2), np.nan), np.full((count, 2, 2), np.nan)
    number = dots.index[dots.ok, 1] * cols + dots.index[dots.ok, 0]
    place[number], covariance[number] = dots.position[dots.ok], dots.covariance[dots.ok]
    return place, covariance


def _nearest(corners: np.ndarray, picture: ChessboardPicture, square: np.ndarray) -> np.ndarray:
    """Return the found corner nearest to each true one, whatever its id; NaN where none is near."""
    found = np.full((len(picture.corner), 2), np.nan)
    if len(corners):
        away = np.linalg.norm(picture.corner[:, None] - corners[None], axis=-1)
        near = away.min(axis=1) < OFF_SQUARES * square
        found[near] = corners[away.argmin(axis=1)[near]]
    return found


def _bounds(picture: ChessboardPicture, number: int) -> np.ndarray:
    """Return the least covariances of a corner, with the mean variance, and with those of black and white."""
    centre, exposure = picture.corner[number], picture.exposure
    light = float(exposure.light(centre))
    row, col = divmod(number, picture.board.cols)
    corner = ImagedCorner(
        centre, picture.axes(number), exposure.blur_px, INK * light, PAPER * light,
        clear=picture.board.clear_reach(col, row),
    )  # fmt: skip
    ink, paper = (exposure.noise**2 * light * level + ROUNDING for level in (INK, PAPER))
    mean = 0.5 * (ink + paper)
    return corner_bounds(corner, np.sqrt([[mean, mean], [ink, paper]]))


def _rms(errors: np.ndarray) -> float:
    return float(np.sqrt((errors**2).sum(axis=1).mean())) if len(errors) else float("nan")


def _median(values: list[float]) -> float:
    return float(np.median(values)) if values else float("nan")
