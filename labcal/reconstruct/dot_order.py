"""Matches of dots that are certain, and candidates left out since they contradict the order of these."""

import numpy as np

from labcal.arrays import Mask
from labcal.cameras.camera import Camera
from labcal.reconstruct.pair_candidates import Candidates

_GRADIENT = 1.0
"""Most disparity gradient of neighbours on one surface (Burt and Julesz 1980)."""
_NEIGHBOURS = 6
_FEWEST = 3
_ROUNDS = 20


def resolved_by_order(
    cameras: tuple[Camera, Camera], q: tuple[np.ndarray, np.ndarray], found: Candidates
) -> tuple[Candidates, Candidates]:
    """Return certain matches, and the candidates of dots that have no certain one.

    A candidate is certain where neither of its dots has another. Of the others those are left out whose
    disparity differs from that of certain neighbours by more than a surface allows, until nothing changes.
    The order of dots along epipolar lines, too, is that of a limited disparity gradient: 2 would be a change
    of order (Pollard, Mayhew and Frisby 1985).

    Parameters
    ----------
    cameras : tuple of Camera
    q : tuple of ndarray, shapes (n, 2) and (m, 2)
        Pixels of either camera.
    found : Candidates
    """
    place = _epipolar_coordinates(cameras, q, found)
    alive = np.ones(len(found.first), dtype=bool)
    for _ in range(_ROUNDS):
        certain = _only_ones(found, alive)
        wrong = alive & ~_in_order(place, certain)
        # A certain one that its neighbours contradict is no anchor, and no match either.
        wrong &= ~certain | (_of_others(found, alive) == 0)
        if not wrong.any():
            break
        alive &= ~wrong
    certain = _only_ones(found, alive) & _in_order(place, _only_ones(found, alive))
    matched = np.isin(found.first, found.first[certain]) | np.isin(found.second, found.second[certain])
    return found.where(certain), found.where(~matched)


def _only_ones(found: Candidates, alive: Mask) -> Mask:
    """Tell which candidates are the only ones of both of their dots."""
    return np.asarray(alive & (_of_others(found, alive) == 0))


def _of_others(found: Candidates, alive: Mask) -> np.ndarray:
    """Return how many other candidates the two dots of each have."""
    counts = [
        np.bincount(side[alive], minlength=int(side.max(initial=0)) + 1)[side]
        for side in (found.first, found.second)
    ]
    return np.asarray(counts[0] + counts[1] - 2 * alive)


def _epipolar_coordinates(
    cameras: tuple[Camera, Camera], q: tuple[np.ndarray, np.ndarray], found: Candidates
) -> np.ndarray:
    """Return angles along and across epipolar planes, (candidates, 2 cameras, 2), rad.

    The first one is the angle from the baseline, the second one that of the plane around it, times the sine
    of the first one, so that both are angles seen from the camera.
    """
    rays = [camera.rays(pixels) for camera, pixels in zip(cameras, q, strict=True)]
    baseline = np.nanmedian(rays[1].origin, axis=0) - np.nanmedian(rays[0].origin, axis=0)
    baseline = baseline / np.linalg.norm(baseline)
    mean = np.nanmean(rays[0].direction, axis=0)
    up = mean - (mean @ baseline) * baseline
    up /= np.linalg.norm(up)
    side = np.cross(baseline, up)
    places = []
    for ray, rows in zip(rays, (found.first, found.second), strict=True):
        v = ray.direction[rows]
        along = np.arccos(np.clip(v @ baseline, -1.0, 1.0))
        places.append(np.stack([along, np.arctan2(v @ side, v @ up) * np.sin(along)], axis=-1))
    return np.stack(places, axis=1)


def _in_order(place: np.ndarray, certain: Mask) -> Mask:
    """Tell which candidates agree with most of the certain ones around them; all where there are too few."""
    anchors = np.flatnonzero(certain)
    right = np.ones(len(place), dtype=bool)
    if len(anchors) <= _FEWEST:
        return right
    for number in range(len(place)):
        others = anchors[anchors != number]
        off = place[others] - place[number]
        away = np.linalg.norm(off.mean(axis=1), axis=1)
        nearest = np.argsort(np.linalg.norm(off[:, 0], axis=1), kind="stable")[:_NEIGHBOURS]
        change = np.abs(off[nearest, 0, 0] - off[nearest, 1, 0])
        right[number] = (change <= _GRADIENT * away[nearest]).mean() >= 0.5  # noqa: PLR2004 -- most
    return right
