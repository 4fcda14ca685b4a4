"""Comparison of the corners that are found in a drawn picture with the truth and with OpenCV's."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from labcal.arrays import Mask, Pixels
from labcal.bench.boards.board_view import BoardPicture
from labcal.detect.dots import PictureDots

PICTURES, QUICK_PICTURES = 200, 16
OFF_SQUARES = 0.25
"""Error above which the id of a measured corner counts as wrong, in squares."""
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
    bound, second_bound : ndarray, shape (m, 2, 2)
        The least covariances possible: the one that is checked, and one beside it.
    opencv : dict of str to ndarray, shape (k, 2)
        Errors of OpenCV's corners, by way, px; none where it finds no board.
    own : dict of str to ndarray, shape (k, 2)
        Errors of labcal's on the same corners.
    seconds : dict of str to float
        Times, labcal's by the name "labcal".
    """

    indexed: bool
    wrong: int
    missed: int
    error: np.ndarray
    covariance: np.ndarray
    bound: np.ndarray
    second_bound: np.ndarray
    opencv: dict[str, np.ndarray]
    own: dict[str, np.ndarray]
    seconds: dict[str, float]


@dataclass(frozen=True)
class TrueCorners:
    """The corners of a drawn picture, and how they are judged.

    Attributes
    ----------
    corner : ndarray, shape (n, 2)
        Px, in the order of the board's numbers.
    visible : ndarray of bool, shape (n,)
    near_px : ndarray, shape (n,)
        Distance beyond which a found corner is another one.
    cols : int
        Of the board's numbers in a row.
    bounds : callable
        Returns the two bounds of a corner by its number, shape (2, 2, 2).
    most_bounds : int
        Corners whose bound is computed, drawn at random.
    """

    corner: Pixels
    visible: Mask
    near_px: np.ndarray
    cols: int
    bounds: Callable[[int], np.ndarray]
    most_bounds: int

    def nearest(self, corners: np.ndarray) -> np.ndarray:
        """Return the found corner nearest to each true one, whatever its id; NaN where none is near."""
        found = np.full((len(self.corner), 2), np.nan)
        if len(corners):
            away = np.linalg.norm(self.corner[:, None] - corners[None], axis=-1)
            near = away.min(axis=1) < self.near_px
            found[near] = corners[away.argmin(axis=1)[near]]
        return found


def true_corners(
    picture: BoardPicture[object],
    side_px: np.ndarray,
    cols: int,
    bounds: tuple[Callable[[int], np.ndarray], int],
) -> TrueCorners:
    """Return the corners of a picture; near is a quarter of a side (n,), px."""
    return TrueCorners(picture.corner, picture.visible, OFF_SQUARES * side_px, cols, *bounds)


def board_outcome(
    truth: TrueCorners,
    dots: PictureDots,
    opencv: Mapping[str, np.ndarray],
    seconds: dict[str, float],
    random: np.random.Generator,
) -> BoardOutcome:
    """Compare the corners of a picture with the truth, and OpenCV's beside them.

    Parameters
    ----------
    truth : TrueCorners
    dots : PictureDots
        As detected.
    opencv : mapping of str to ndarray, shape (n, 2)
        OpenCV's corner for each true one, by way, px; NaN where it has none. Those far off do not count.
    seconds : dict of str to float
    random : Generator
        Which corners are compared with their bound.
    """
    count = len(truth.corner)
    place, covariance = np.full((count, 2), np.nan), np.full((count, 2, 2), np.nan)
    number = dots.index[dots.ok, 1] * truth.cols + dots.index[dots.ok, 0]
    place[number], covariance[number] = dots.position[dots.ok], dots.covariance[dots.ok]
    off = place - truth.corner
    measured = np.isfinite(off).all(axis=1)
    some = np.sort(random.permutation(np.flatnonzero(measured & truth.visible))[: truth.most_bounds])
    bounds = np.array([truth.bounds(k) for k in some.tolist()]).reshape(-1, 2, 2, 2)
    theirs, own = {}, {}
    for way, corners in opencv.items():
        error = corners - truth.corner
        both = measured & truth.visible & _is_near(error, truth.near_px)
        theirs[way], own[way] = error[both], off[both]
    return BoardOutcome(
        indexed=dots.indexed,
        wrong=int((measured & ~_is_near(off, truth.near_px)).sum()),
        missed=int((truth.visible & ~measured).sum()),
        error=off[some],
        covariance=covariance[some],
        bound=bounds[:, 0],
        second_bound=bounds[:, 1],
        opencv=theirs,
        own=own,
        seconds=seconds,
    )


def _is_near(errors: np.ndarray, near_px: np.ndarray) -> Mask:
    """Return which errors (n, 2) are no larger than that; NaN are not."""
    with np.errstate(invalid="ignore"):
        return np.asarray(np.linalg.norm(errors, axis=1) <= near_px)
