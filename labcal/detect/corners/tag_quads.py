"""Tags of an AprilGrid in a picture: four saddle points around a square whose cells are a code."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float64
from scipy.spatial import cKDTree

from labcal.arrays import Pixels
from labcal.detect.corners.saddles import Saddles
from labcal.detect.grey import GreyPicture
from labcal.geometry.projective_map import homogeneous, projective_map
from labcal.targets.april_grid import AprilGrid
from labcal.targets.charuco_opencv import opencv_dictionary

_NEAREST = 48
"""Saddle points among which the next one along an edge is looked for."""
_MOST_TURN = 0.35
"""Most angle between an edge and the way to the next saddle point along it, rad."""
_USUAL_TURN = 0.07
"""Angle at which a point counts as twice as far: a cell's corner may be nearer than the tag's."""
_CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
"""Of a tag, in tags: as it is printed, anticlockwise from the lower left one."""
_LEAST_CONTRAST = 4.0
"""Between black and white cells, in the standard deviations of either."""
_MOST_WRONG_BORDER = 0.06
"""Share of the border's cells that may be white: something small over them."""
_CORRECTED = 0.6
"""Share of the wrong cells that a set of tags could correct which are corrected; OpenCV's own default."""


@dataclass(frozen=True)
class SeenTags:
    """Tags that are read in a picture.

    Attributes
    ----------
    number : ndarray of int, shape (n,)
        Their ids.
    corners : ndarray, shape (n, 4, 2)
        px, anticlockwise on the print from the lower left one.
    """

    number: np.ndarray
    corners: Float64[np.ndarray, "n 4 2"]


def read_tags(grey: GreyPicture, saddles: Saddles, grid: AprilGrid) -> SeenTags:
    """Return the tags of a grid's set between saddle points of a picture.

    Contours, from which OpenCV's detector begins, run together where tags and small squares touch; saddle
    points are where they do.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
    saddles : Saddles
        Of the picture.
    grid : AprilGrid
        Its set of tags and their border count alone.
    """
    dictionary = opencv_dictionary(grid.dictionary)
    numbers, corners = [], []
    for quad in _quads(saddles):
        places = saddles.place[list(quad)]
        bits = _bits(grey, places, dictionary.markerSize, grid.border_cells)
        if bits is None:
            continue
        known, number, turn = dictionary.identify(bits, _CORRECTED)
        if known:
            # OpenCV counts quarter turns of its own picture of the tag, half a turn from Kalibr's print.
            numbers.append(int(number))
            corners.append(np.roll(places, -(int(turn) + 2), axis=0))
    return SeenTags(np.array(numbers, dtype=np.int64), np.array(corners).reshape(-1, 4, 2))


def _quads(saddles: Saddles) -> list[tuple[int, int, int, int]]:
    """Return four saddle points around black squares, anticlockwise as seen, each once."""
    n = len(saddles.place)
    if n < len(_CORNERS):
        return []
    ways = np.concatenate([saddles.edges, saddles.edges + np.pi], axis=1)  # ascending angles from x to y
    following = _following(saddles.place, ways)
    every = np.arange(n)
    found: dict[frozenset[int], tuple[int, int, int, int]] = {}
    for way in range(4):
        after = (way + 1) % 4
        start, end = ways[:, way], ways[:, after] + (2.0 * np.pi if after == 0 else 0.0)
        black = ~saddles.is_white(every, 0.5 * (start + end))
        for p in np.flatnonzero(black).tolist():
            # From x to y is clockwise as seen, with y down: b, p, a run clockwise, so p, b, c, a does not.
            a, b = following[p, way], following[p, after]
            if a < 0 or b < 0:
                continue
            c = {int(k) for k in following[a] if k >= 0} & {int(k) for k in following[b] if k >= 0} - {p}
            for last in c:
                quad = (p, int(b), last, int(a))
                if len(set(quad)) == len(quad):
                    found.setdefault(frozenset(quad), quad)
    return list(found.values())


def _following(place: Pixels, ways: np.ndarray) -> np.ndarray:
    """Return the next point along each way from each point, shape (n, 4); -1 where there is none."""
    count = min(_NEAREST + 1, len(place))
    distance, near = cKDTree(place).query(place, count)
    found = np.full(ways.shape, -1)
    for p in range(len(place)):
        towards = (place[near[p, 1:]] - place[p]) / np.maximum(distance[p, 1:, None], 1e-9)
        for way in range(ways.shape[1]):
            across = np.array([-np.sin(ways[p, way]), np.cos(ways[p, way])])
            turn = np.arctan2(towards @ across, towards @ [across[1], -across[0]])
            cost = np.where(
                np.abs(turn) < _MOST_TURN, distance[p, 1:] * (1.0 + (turn / _USUAL_TURN) ** 2), np.inf
            )
            best = int(cost.argmin())
            if np.isfinite(cost[best]):
                found[p, way] = near[p, 1 + best]
    return found


def _bits(grey: GreyPicture, quad: Pixels, size: int, border: int) -> np.ndarray | None:
    """Return the inner cells of a square, 1 for white ones; None where it has no black border."""
    cells = size + 2 * border
    shares = (np.arange(cells) + 0.5) / cells
    x, y = np.meshgrid(shares, shares[::-1])  # the top row first
    H = projective_map("tag", _CORNERS, quad)
    near = 0.2 / cells * np.array([[0.0, 0.0], [1, 1], [-1, 1], [1, -1], [-1, -1]])
    xyw = homogeneous((np.stack([x, y], axis=-1)[..., None, :] + near).reshape(-1, 2)) @ H.T
    if (xyw[:, 2] <= 0).any():
        return None
    q = (xyw[:, :2] / xyw[:, 2:]).astype(np.float32)
    value = cv2.remap(grey, q[:, 0], q[:, 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    level = value.reshape(cells, cells, len(near)).mean(axis=2).astype(np.float64)
    inner = np.zeros((cells, cells), dtype=bool)
    inner[border:-border, border:-border] = True
    # The white beside the tag is as bright as its white cells.
    black, white = float(np.median(level[~inner])), float(np.percentile(level[inner], 90))
    spread = float(np.median(np.abs(level[~inner] - black))) * 1.4826
    if white - black < _LEAST_CONTRAST * max(spread, 1e-6):
        return None
    is_white = level > 0.5 * (black + white)
    if is_white[~inner].mean() > _MOST_WRONG_BORDER:
        return None
    return np.ascontiguousarray(is_white[border:-border, border:-border].astype(np.uint8))
