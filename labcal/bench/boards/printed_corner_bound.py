"""The Cramer-Rao bound of a corner on a print whose ink around it is known, as beside the markers of a board.

As :mod:`labcal.bench.boards.corner_bound`, but all that is printed around the corner moves with it and so
tells of its place: the edges of the squares, and those of markers in them.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from labcal.bench.boards.corner_bound import FINER, STEP
from labcal.bench.detect.bound import place_bounds
from labcal.bench.marks.drawn_picture import Cover, Print

_REACH_SIGMAS = 4.0
_REACH = 0.5
"""Pixels count up to so many squares from the corner, along either edge: beyond, the next one is nearer."""
_CLEAR_BLURS = 2.0
"""Distance from what covers the print at which pixels see the print alone."""


@dataclass(frozen=True)
class PrintedCorner:
    """The parameters of the image of a corner.

    Attributes
    ----------
    centre : ndarray, shape (2,)
        px.
    axes : ndarray, shape (2, 2)
        Columns: one square along x and y of the print, px.
    blur_px : float
        Standard deviation of the point spread, before the pixel's own width.
    dark, light : float
        Levels of ink and paper, in the unit of the noise.
    ink : callable
        Share of ink at places around the corner, in squares from it.
    covers : tuple of Cover
        In front of the print: what lies behind them tells nothing.
    """

    centre: np.ndarray
    axes: np.ndarray
    blur_px: float
    dark: float
    light: float
    ink: Print
    covers: tuple[Cover, ...] = ()


def printed_corner_bounds(corner: PrintedCorner, noises: np.ndarray) -> np.ndarray:
    """Return the least covariances of a corner's place under several noises, px squared, shape (k, 2, 2).

    Unknown are the place, the directions of both axes, blur, both levels and the slope of the light.

    Parameters
    ----------
    corner : PrintedCorner
    noises : ndarray, shape (k, 2)
        Standard deviations of pixels of ink and of paper, in the unit of the levels.

    Notes
    -----
    The inverse of the Fisher information (Kay 1993, section 3.9), its block of the corner.
    """
    return place_bounds(*_derivatives(corner), noises)


def _derivatives(corner: PrintedCorner) -> tuple[np.ndarray, np.ndarray]:
    """Return derivatives by every parameter at the pixels that count, (9, n), and their shares of ink."""
    extent = np.abs(corner.axes).sum(axis=1) * _REACH + 1.0
    low = np.floor(corner.centre - extent).astype(int)
    width, height = (np.ceil(corner.centre + extent).astype(int) - low + 1).tolist()
    centre = corner.centre - low
    lengths = np.linalg.norm(corner.axes, axis=0)
    at = np.array([*centre, *np.arctan2(corner.axes[1], corner.axes[0]), corner.blur_px])
    steps = STEP * np.array([1.0, 1.0, *(1.0 / (_REACH * lengths)), 1.0])
    fall = corner.dark - corner.light
    shaped = []
    for number, step in enumerate(steps):
        by = np.zeros(5)
        by[number] = step
        up, down = (printed_share(corner, at + sign * by, (width, height)) for sign in (1.0, -1.0))
        shaped.append(fall * (up - down) / (2.0 * step))
    share = printed_share(corner, at, (width, height))
    y, x = np.mgrid[:height, :width]
    away = np.stack([x - centre[0], y - centre[1]])
    level = (corner.light + fall * share) / corner.light
    along = np.einsum("ij,jhw->ihw", np.linalg.inv(corner.axes), away)
    inside = np.abs(along).max(axis=0) <= _REACH
    q = np.stack([x + low[0], y + low[1]], axis=-1).astype(np.float64)
    for cover in corner.covers:
        inside &= cover.distance(q) > _CLEAR_BLURS * corner.blur_px
    D = np.stack([*shaped, 1.0 - share, share, level * away[0], level * away[1]])
    return D[:, inside], share[inside]


def printed_share(corner: PrintedCorner, parameters: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """Return the share of every pixel that is ink, shape (height, width).

    Parameters
    ----------
    corner : PrintedCorner
        Its ink and the lengths of its axes count.
    parameters : ndarray, shape (5,)
        Place x and y in the window, px; directions of both axes, rad; blur, px.
    size : (int, int)
        Width and height of the window, px.
    """
    x, y, first, second, blur = parameters.tolist()
    width, height = size
    border = int(np.ceil(_REACH_SIGMAS * blur))
    rows, columns = (
        (np.arange(FINER * (n + 2 * border)) + 0.5) / FINER - 0.5 - border for n in (height, width)
    )
    directions = np.array([[np.cos(first), np.cos(second)], [np.sin(first), np.sin(second)]])
    inverse = np.linalg.inv(directions * np.linalg.norm(corner.axes, axis=0))
    dx, dy = np.meshgrid(columns - x, rows - y)
    sharp = corner.ink(*(one[0] * dx + one[1] * dy for one in inverse))
    fine = cv2.GaussianBlur(sharp, (0, 0), blur * FINER, borderType=cv2.BORDER_REPLICATE)
    inner = fine[border * FINER : (border + height) * FINER, border * FINER : (border + width) * FINER]
    return np.asarray(inner.reshape(height, FINER, width, FINER).mean(axis=(1, 3)))
