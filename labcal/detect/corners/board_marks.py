"""Marks of a chessboard: round dots of the opposite colour in the middle of a lattice's cells."""

import numpy as np
from scipy.ndimage import map_coordinates

from labcal.detect.corners.saddles import Saddles
from labcal.detect.grey import GreyPicture
from labcal.detect.lattice.lattice import Lattice, Node
from labcal.detect.stage_settings.saddle import SaddleSettings

_CORNERS: tuple[Node, ...] = ((0, 0), (1, 0), (1, 1), (0, 1))
_OUTER = 0.55
"""Of the way from the middle of a cell to its corners: as far from the mark as from the next squares."""

_INNER_PATCH, _OUTER_PATCH = 0.12, 0.08
"""Half the side of the patches whose mean level is taken, of the cell's: within a mark, and beside it."""
_SAMPLES = np.linspace(-1.0, 1.0, 5)
_HALF = 0.5
"""Of a cell's corners, which tell its colour."""


def read_marks(
    lattice: Lattice, saddles: Saddles, grey: GreyPicture, settings: SaddleSettings
) -> dict[Node, bool]:
    """Return which cells of a lattice, by their first corner, have a mark; cells in doubt are left out.

    Parameters
    ----------
    lattice : Lattice
    saddles : Saddles
    grey : ndarray, shape (h, w)
        The picture, as it was not blurred: marks are small.
    settings : SaddleSettings
    """
    spots = lattice.spots
    cells = [(a, b) for a, b in spots if all((a + i, b + j) in spots for i, j in _CORNERS)]
    if not cells:
        return {}
    corner = np.array([[spots[a + i, b + j] for i, j in _CORNERS] for a, b in cells])
    q = saddles.place[corner]
    middle = _crossing(q)
    outside = middle[:, None] + _OUTER * (q - middle[:, None])
    along, up = _steps(q)
    inner = _levels(grey, middle[:, None], _INNER_PATCH * along, _INNER_PATCH * up)[:, 0]
    outer = _levels(grey, outside, _OUTER_PATCH * along, _OUTER_PATCH * up)
    step = np.median(saddles.step[corner], axis=1)
    way = middle[:, None] - q
    white = saddles.is_white(corner, np.arctan2(way[..., 1], way[..., 0])).mean(axis=1) > _HALF
    contrast = np.where(white, 1.0, -1.0) * (outer.mean(axis=1) - inner) / step
    # Blur takes the next squares into what is beside a mark: plain squares are below nothing.
    contrast -= min(float(np.median(contrast)), 0.0)
    even = np.ptp(outer, axis=1) < settings.min_mark_share * step
    marked = (contrast > settings.min_mark_share) & even
    plain = (contrast < settings.max_plain_share) & even
    return {cell: bool(marked[k]) for k, cell in enumerate(cells) if marked[k] or plain[k]}


def _crossing(q: np.ndarray) -> np.ndarray:
    """Return where the diagonals of cells (n, 4, 2) cross: the middle of the square, in perspective."""
    first, second = q[:, 2] - q[:, 0], q[:, 3] - q[:, 1]
    between = q[:, 1] - q[:, 0]
    cross = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    share = (between[:, 0] * second[:, 1] - between[:, 1] * second[:, 0]) / np.where(
        cross == 0.0, np.inf, cross
    )
    return np.asarray(q[:, 0] + share[:, None] * first)


def _steps(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the mean sides of cells (n, 4, 2) along both axes, shape (n, 1, 2)."""
    along = 0.5 * (q[:, 1] - q[:, 0] + q[:, 2] - q[:, 3])
    up = 0.5 * (q[:, 3] - q[:, 0] + q[:, 2] - q[:, 1])
    return along[:, None], up[:, None]


def _levels(picture: GreyPicture, q: np.ndarray, along: np.ndarray, up: np.ndarray) -> np.ndarray:
    """Return the mean levels around places (n, k, 2), px: interpolated, over a patch against the noise.

    `along` and `up` (n, 1, 2) are half the patch's sides.
    """
    places = np.array([q + i * along + j * up for i in _SAMPLES for j in _SAMPLES])
    at = [places[..., 1], places[..., 0]]
    return np.asarray(map_coordinates(picture, at, order=1, mode="nearest").mean(axis=0))
