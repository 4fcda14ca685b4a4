"""Markers that are where one another say they should be, as a board has them, through wide lenses, too."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.detect.corners.seen_markers import SeenMarkers
from labcal.detect.lattice.rough_undistortion import NONE, RoughUndistortion
from labcal.geometry.projective_map import homogeneous, projective_map, robust_homography

NEAREST = 3
"""Markers in place that predict the next one."""
_LEAST_AGREEING = 2
"""Markers: a single one is in place on any board of its dictionary."""
_SEEDS = 12
"""Markers with which the search for those that agree begins, spread over those that are seen."""
_SPARSER = 3
"""Of the seeds, one in so many is tried through each lens: through the right one, hardly any is in vain."""
_LEAST_THROUGH_LENS = 4
"""Markers: some lens takes two that are far apart to each other's places."""
_LEAST_APART = 4
"""Markers that one homography takes to their places, and that are too far apart to predict each other."""
_APART = 0.6
"""Of the distance from its place that a marker may have beside others: here it is all the evidence."""


@dataclass(frozen=True)
class AgreeingMarkers:
    """Markers that agree with one another on a board.

    Attributes
    ----------
    which : list of int
        By number among those that are seen; none where that is no evidence.
    lens : RoughUndistortion
        The lens in whose undistorted picture they agree.
    """

    which: list[int]
    lens: RoughUndistortion = NONE


def markers_that_agree(
    seen: SeenMarkers,
    on_board: Float64[np.ndarray, "n 4 2"],
    limit_squares: float,
    lenses: Sequence[RoughUndistortion] = (),
) -> AgreeingMarkers:
    """Return the largest set of markers that agree, by their corners.

    Evidence are two markers or more, through a wide lens four, and at least half of the ids. A homography
    goes on straight from large markers to the next ones, which a fisheye bends: where not all ids agree,
    lenses are tried.

    Parameters
    ----------
    seen : SeenMarkers
        With ids of the board.
    on_board : ndarray, shape (n, 4, 2)
        Their places, squares or tags.
    limit_squares : float
        Most distance of a corner from where its neighbours predict it.
    lenses : sequence of RoughUndistortion
        Wide ones.
    """
    ids = len(np.unique(seen.number))
    every = sorted(set(np.linspace(0, len(seen.number) - 1, _SEEDS).astype(int).tolist())) if ids else []
    best = AgreeingMarkers(_largest(every, seen, on_board, limit_squares))
    if ids and len(best.which) < ids:
        # A marker that is in place already is one to begin with.
        seeds = best.which[:1] if _is_evidence(best.which, ids) else every[::_SPARSER]
        for lens in lenses:
            found = _largest(seeds, seen, on_board, limit_squares, lens)
            if len(found) > max(len(best.which), _LEAST_THROUGH_LENS - 1):
                best = AgreeingMarkers(found, lens)
            if len(best.which) == ids:
                break
    if _is_evidence(best.which, ids):
        return best
    if ids >= _LEAST_APART:
        for lens in (NONE, *lenses):
            found = _on_one_plane(seen, on_board, _APART * limit_squares, lens)
            if 2 * len(found) >= ids:
                return AgreeingMarkers(found, lens)
    return AgreeingMarkers([])


def ids_seen_again(
    seen: SeenMarkers, on_board: Float64[np.ndarray, "n 4 2"], limit_squares: float, placed: AgreeingMarkers
) -> list[int]:
    """Return the ids of markers in place that agree at another place, too: a second print of the same board.

    Parameters
    ----------
    seen, on_board, limit_squares
        As of :func:`markers_that_agree`.
    placed : AgreeingMarkers
        What it returned.

    Returns
    -------
    list of int
        Sorted; none where fewer than two agree there.
    """
    if len(placed.which) == len(seen.number):
        return []
    at, number = seen.corners.mean(axis=1), seen.number
    side = np.linalg.norm(seen.corners - np.roll(seen.corners, 1, axis=1), axis=2).mean(axis=1)
    first = {int(number[k]): k for k in placed.which}
    elsewhere = [
        k
        for k in range(len(number))
        if (one := first.get(int(number[k]))) is not None
        and np.linalg.norm(at[k] - at[one]) > max(side[k], side[one])
    ]
    if len(elsewhere) < _LEAST_AGREEING:
        return []
    which = np.array(elsewhere)
    seeds = list(range(len(which)))[:_SEEDS]
    again = _largest(seeds, seen.select(which), on_board[which], limit_squares, placed.lens)
    return sorted(number[which[again]].tolist()) if len(again) >= _LEAST_AGREEING else []


def through_markers(
    q: Float64[np.ndarray, "k 4 2"],
    on_board: Float64[np.ndarray, "k 4 2"],
    wanted: Float64[np.ndarray, "n 2"],
    lens: RoughUndistortion = NONE,
) -> Float64[np.ndarray, "n 2"]:
    """Return where points of the board (squares) are seen, px, by the homography of some markers."""
    H = projective_map("markers", on_board.reshape(-1, 2), lens.undistort(q).reshape(-1, 2))
    xyw = homogeneous(wanted) @ H.T
    seen: np.ndarray = xyw[:, :2] / xyw[:, 2:]
    return lens.distort(seen)


def _is_evidence(which: list[int], ids: int) -> bool:
    """Tell whether markers that agree are two or more, and at least half of the ids."""
    return len(which) >= _LEAST_AGREEING and 2 * len(which) >= ids


def _largest(
    seeds: list[int],
    seen: SeenMarkers,
    on_board: Float64[np.ndarray, "n 4 2"],
    limit_squares: float,
    lens: RoughUndistortion = NONE,
) -> list[int]:
    """Return the largest set of markers that agree with one of some, by number in `seen`."""
    best: list[int] = []
    for seed in seeds:
        if seed not in best:
            best = max(best, _agreeing(seed, seen, on_board, limit_squares, lens), key=len)
    return best


def _nearest(placed: list[int], k: int, at: Float64[np.ndarray, "n 2"]) -> list[int]:
    """Return the few markers in place that are nearest to one."""
    away = np.hypot(*(at[placed] - at[k]).T)
    return [placed[one] for one in np.argsort(away, kind="stable")[:NEAREST]]


def _on_one_plane(
    seen: SeenMarkers, on_board: Float64[np.ndarray, "n 4 2"], limit_squares: float, lens: RoughUndistortion
) -> list[int]:
    """Return the markers that one homography takes to their places, by number; none of fewer than four.

    They may be far from each other, which those are not that are predicted from one another.
    """
    H = robust_homography(on_board.reshape(-1, 2), lens.undistort(seen.corners).reshape(-1, 2))
    if H is None:
        return []
    xyw = homogeneous(on_board.reshape(-1, 2)) @ H.T
    off = lens.distort((xyw[:, :2] / xyw[:, 2:]).reshape(-1, 4, 2)) - seen.corners
    sides = np.linalg.norm(seen.corners - np.roll(seen.corners, 1, axis=1), axis=2).mean(axis=1)
    squares = sides / np.linalg.norm(on_board[:, 0] - on_board[:, 1], axis=1)
    near = np.flatnonzero(np.abs(off).max(axis=(1, 2)) < limit_squares * squares).tolist()
    once = list({int(seen.number[k]): k for k in reversed(near)}.values())
    return once if len(once) >= _LEAST_APART else []


def _agreeing(
    seed: int,
    seen: SeenMarkers,
    on_board: Float64[np.ndarray, "n 4 2"],
    limit_squares: float,
    lens: RoughUndistortion,
) -> list[int]:
    """Return the markers that agree with one, by number in `seen`; of one id the first that does."""
    centre = on_board.mean(axis=1)
    placed, taken = [seed], {int(seen.number[seed])}
    distance = np.hypot(*(centre - centre[seed]).T)
    left = {k for k in range(len(centre)) if k != seed}
    while left:
        k = min(left, key=lambda one: (distance[one], one))
        left.remove(k)
        if int(seen.number[k]) in taken:
            continue
        near = _nearest(placed, k, centre)
        predicted = through_markers(seen.corners[near], on_board[near], on_board[k], lens)
        side = np.linalg.norm(seen.corners[k] - np.roll(seen.corners[k], 1, axis=0), axis=1).mean()
        square = side / np.linalg.norm(on_board[k, 0] - on_board[k, 1])
        if np.abs(predicted - seen.corners[k]).max() > limit_squares * square:
            continue
        placed.append(k)
        taken.add(int(seen.number[k]))
        distance = np.minimum(distance, np.hypot(*(centre - centre[k]).T))
    return placed
