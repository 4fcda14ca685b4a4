"""The Cramer-Rao bound of the corner of a chessboard, the least covariance of any unbiased method.

The picture of a corner is modelled here on its own, without the detector: two edges drawn at several times
the resolution, blurred by a Gauss function and averaged over each pixel. What is not known to a detector is
not known to the bound either: corner, directions of both edges, blur, both levels and the slope of the light.
Pixels count up to the middles of the squares, where those of the next corner begin.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from labcal.bench.detect.bound import place_bounds

FINER = 5
"""Drawn at so many times the resolution."""
STEP = 0.02
"""Of the numerical derivatives, px."""
_REACH_SIGMAS = 4.0


@dataclass(frozen=True)
class ImagedCorner:
    """The parameters of the image of a corner.

    Attributes
    ----------
    centre : ndarray, shape (2,)
        px.
    axes : ndarray, shape (2, 2)
        Columns: one square along either edge, px.
    blur_px : float
        Standard deviation of the point spread, before the pixel's own width.
    dark, light : float
        Levels of black and white, in the unit of the noise.
    reach : float
        Pixels count up to so many squares from either edge.
    clear : float
        And of these, those that are so near to one of the edges: there may be a marker beyond.
    mark : float
        And those farther from the middles of the squares, where there may be a round mark.
    """

    centre: np.ndarray
    axes: np.ndarray
    blur_px: float
    dark: float
    light: float
    reach: float = 0.5
    clear: float = 1.0
    mark: float = 0.0

    @property
    def directions(self) -> np.ndarray:
        """Vectors along both edges, in columns, between which it is white."""
        return self.axes

    def counts(self, along: np.ndarray) -> np.ndarray:
        """Return which pixels count, by their coordinates along the edges (2, h, w), in squares."""
        away = np.abs(along)
        plain = (away.min(axis=0) <= self.clear) & (np.hypot(*(0.5 - away)) >= self.mark)
        return np.asarray((away.max(axis=0) <= self.reach) & plain)


@dataclass(frozen=True)
class ImagedTagCorner(ImagedCorner):
    """The parameters of the image of a corner of a tag, where a small square touches it.

    The axes are the tag's edges, into the tag. Pixels count to the middles of all four edges that meet: in
    the tag up to its cells, beside it and in the small square up to the middle of the white space.

    Attributes
    ----------
    gap : float
        Side of the small square, in tags.
    border : float
        Width of the tag's black border, in tags.
    """

    gap: float = 0.3
    border: float = 0.2

    @property
    def directions(self) -> np.ndarray:
        """Vectors along both edges, in columns, between which it is white."""
        return np.asarray(self.axes * [1.0, -1.0])

    def counts(self, along: np.ndarray) -> np.ndarray:
        """Return which pixels count, by their coordinates along the edges (2, h, w), in tags."""
        nearest, farthest = along.min(axis=0), along.max(axis=0)
        return np.asarray(
            (nearest >= -self.reach * self.gap) & (farthest <= self.reach) & (nearest <= self.border)
        )


def corner_bounds(corner: ImagedCorner, noises: np.ndarray) -> np.ndarray:
    """Return the least covariances of a corner's place under several noises, px squared, shape (k, 2, 2).

    Parameters
    ----------
    corner : ImagedCorner
    noises : ndarray, shape (k, 2)
        Standard deviations of pixels of black and of white, in the unit of the levels. Between the two the
        variance grows in a line with the light, as that of photons does.

    Notes
    -----
    The inverse of the Fisher information of nine parameters (Kay 1993, section 3.9), its block of the corner.
    """
    return place_bounds(*_derivatives(corner), noises)


def _derivatives(corner: ImagedCorner) -> tuple[np.ndarray, np.ndarray]:
    """Return derivatives by every parameter at the pixels that count, (9, n), and their shares of black."""
    extent = np.abs(corner.axes).sum(axis=1) * corner.reach + 1.0
    low = np.floor(corner.centre - extent).astype(int)
    width, height = (np.ceil(corner.centre + extent).astype(int) - low + 1).tolist()
    centre = corner.centre - low
    angles = np.arctan2(corner.directions[1], corner.directions[0])
    at = np.array([*centre, *angles, corner.blur_px])
    length = corner.reach * np.linalg.norm(corner.axes, axis=0)
    steps = STEP * np.array([1.0, 1.0, *(1.0 / length), 1.0])
    fall = corner.dark - corner.light
    shaped = []
    for number, step in enumerate(steps):
        by = np.zeros(5)
        by[number] = step
        up, down = _black(at + by, (width, height)), _black(at - by, (width, height))
        shaped.append(fall * (up - down) / (2.0 * step))
    black = _black(at, (width, height))
    y, x = np.mgrid[:height, :width]
    away = np.stack([x - centre[0], y - centre[1]])
    level = (corner.light + fall * black) / corner.light
    along = np.einsum("ij,jhw->ihw", np.linalg.inv(corner.axes), away)
    inside = corner.counts(along)
    D = np.stack([*shaped, 1.0 - black, black, level * away[0], level * away[1]])
    return D[:, inside], black[inside]


def _black(parameters: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """Return the share of every pixel that is black, shape (height, width).

    Parameters
    ----------
    parameters : ndarray, shape (5,)
        Corner, directions of both edges, blur.
    size : (int, int)
        Width and height, px.
    """
    x, y, first, second, blur = parameters.tolist()
    width, height = size
    border = int(np.ceil(_REACH_SIGMAS * blur))
    rows, columns = (
        (np.arange(FINER * (n + 2 * border)) + 0.5) / FINER - 0.5 - border for n in (height, width)
    )
    # Distances from the edges; within a sample of one the share of black changes in a line.
    u, v = (
        np.clip(FINER * (np.cos(angle) * (rows[:, None] - y) - np.sin(angle) * (columns - x)), -0.5, 0.5)
        for angle in (first, second)
    )
    black = 0.5 + 2.0 * u * v
    fine = cv2.GaussianBlur(black, (0, 0), blur * FINER, borderType=cv2.BORDER_REPLICATE)
    inner = fine[border * FINER : (border + height) * FINER, border * FINER : (border + width) * FINER]
    return np.asarray(inner.reshape(height, FINER, width, FINER).mean(axis=(1, 3)))
