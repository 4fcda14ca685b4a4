"""Pixels of the fit of a corner: those around it that belong to its own edges, in compiled code."""

from dataclasses import dataclass, field
from math import ceil, cos, floor, hypot, inf, sin, sqrt
from typing import NamedTuple

import numpy as np

from labcal.detect.compiled import compiled

_MARK_GUARD = 2.5
"""Distance kept from marks, in that kept from markers: a fit subtracts the darkness of markers alone."""


@dataclass(frozen=True)
class Surroundings:
    """Surroundings of a corner: where it is, its squares and the nearest markers.

    Attributes
    ----------
    centre : ndarray, shape (2,)
        Where the corner is, px, to about a pixel.
    axes : ndarray, shape (2, 2)
        Columns: one square along the board's x and y, px.
    white : int
        1 where the upper right square of the board (and the lower left one) is white, -1 where it is black.
    gap : float
        White between a corner and the nearest marker, along x and along y, in squares.
    reach : float
        How far the edges are straight enough, px.
    clear : float
        Distance from either edge at which round marks in the middles of squares of either colour may begin,
        in squares; 1 where there are none.
    share : float
        How far from the corner the pixels reach, in squares.
    most : float
        Grey value from which on pixels are clipped, and left out.
    bend : ndarray, shape (2,)
        Curvature of either edge towards its normal, 1/px.
    """

    centre: np.ndarray
    axes: np.ndarray
    white: int
    gap: float
    reach: float
    clear: float = 1.0
    share: float = 0.45
    most: float = inf
    bend: np.ndarray = field(default_factory=lambda: np.zeros(2))

    @property
    def limits(self) -> "WindowLimits":
        """The same for compiled code."""
        return WindowLimits(float(self.white), self.gap, self.clear, self.reach, self.share, self.most)


class Places(NamedTuple):
    """Surroundings of n corners.

    Attributes
    ----------
    centre : ndarray, shape (n, 2)
    axes : ndarray, shape (n, 2, 2)
    bend : ndarray, shape (n, 2)
    limits : ndarray, shape (n, 6)
        The values of :class:`WindowLimits`.
    """

    centre: np.ndarray
    axes: np.ndarray
    bend: np.ndarray
    limits: np.ndarray

    @classmethod
    def of(cls, around: Surroundings) -> "Places":
        """Return the surroundings of one corner."""
        one = (around.centre, around.axes, around.bend, around.limits)
        return cls(*(np.array([part], dtype=np.float64) for part in one))


class WindowLimits(NamedTuple):
    """The parts of a corner's surroundings that say which pixels are its own."""

    white: float
    gap: float
    clear: float
    reach: float
    share: float
    most: float


@compiled
def with_clipped(limits: WindowLimits) -> WindowLimits:
    """Return limits that keep the pixels which are clipped."""
    return WindowLimits(limits.white, limits.gap, limits.clear, limits.reach, limits.share, inf)


@compiled
def narrowest(axes: np.ndarray) -> float:
    """Return the smaller singular value of a matrix, shape (2, 2)."""
    half = 0.5 * (axes[0, 0] ** 2 + axes[0, 1] ** 2 + axes[1, 0] ** 2 + axes[1, 1] ** 2)
    det = axes[0, 0] * axes[1, 1] - axes[0, 1] * axes[1, 0]
    return sqrt(max(half - sqrt(max(half * half - det * det, 0.0)), 0.0))


@compiled
def pixel_box(
    shape: tuple[int, int], centre: np.ndarray, across: float, down: float
) -> tuple[int, int, int, int]:
    """Return the first column and row of the pixels so far from a centre at most, and how many there are."""
    left, top = max(ceil(centre[0] - across), 0), max(ceil(centre[1] - down), 0)
    right, bottom = min(floor(centre[0] + across), shape[1] - 1), min(floor(centre[1] + down), shape[0] - 1)
    return left, top, max(right - left + 1, 0), max(bottom - top + 1, 0)


@compiled
def window_arrays(
    grey: np.ndarray, place: tuple[np.ndarray, np.ndarray], limits: WindowLimits, guard: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return mask, offsets, values and gap of :class:`~labcal.detect.corners.corner_model.CornerPixels`.

    `place` holds the corner's centre and axes.
    """
    centre, axes = place
    x, y, reach = centre[0], centre[1], limits.reach
    across = min(reach, limits.share * (abs(axes[0, 0]) + abs(axes[0, 1])))
    down = min(reach, limits.share * (abs(axes[1, 0]) + abs(axes[1, 1])))
    left, top, wide, high = pixel_box(grey.shape, centre, across, down)
    mask = np.zeros((high, wide), dtype=np.bool_)
    offset, value = np.empty((2, high * wide)), np.empty(high * wide)
    det = axes[0, 0] * axes[1, 1] - axes[0, 1] * axes[1, 0]
    along_x, along_y, up_x, up_y = axes[1, 1] / det, -axes[0, 1] / det, -axes[1, 0] / det, axes[0, 0] / det
    # Heights of the parallelogram that a square is in the picture.
    gap = np.empty(2)
    gap[0] = limits.gap * abs(det) / hypot(axes[0, 1], axes[1, 1])
    gap[1] = limits.gap * abs(det) / hypot(axes[0, 0], axes[1, 0])
    mark = 0.5 - limits.clear + _MARK_GUARD * guard if limits.clear < 1.0 else 0.0
    n, far = 0, reach * reach
    for j in range(high):
        for i in range(wide):
            dx, dy = left + i - x, top + j - y
            along, up = along_x * dx + along_y * dy, up_x * dx + up_y * dy
            nearest, farthest = min(abs(along), abs(up)), max(abs(along), abs(up))
            marked = along * up * limits.white > 0.0 and nearest > limits.gap - guard
            if (
                marked
                or hypot(0.5 - nearest, 0.5 - farthest) < mark
                or farthest >= limits.share
                or dx * dx + dy * dy >= far
                or grey[top + j, left + i] >= limits.most
            ):
                continue
            mask[j, i] = True
            offset[0, n], offset[1, n], value[n] = dx, dy, grey[top + j, left + i]
            n += 1
    return mask, offset[:, :n].copy(), value[:n].copy(), gap


@compiled
def near_edges(
    window: tuple[np.ndarray, np.ndarray, np.ndarray], state: np.ndarray, blurs: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return mask, offsets and values of the pixels of a window that are so near to an edge, in blurs."""
    mask, offset, value = window
    kept = np.zeros(mask.shape, dtype=np.bool_)
    near = np.empty(len(value), dtype=np.int64)
    c0, s0, c1, s1 = cos(state[2]), sin(state[2]), cos(state[3]), sin(state[3])
    n = k = 0
    for j in range(mask.shape[0]):
        for i in range(mask.shape[1]):
            if not mask[j, i]:
                continue
            dx, dy = offset[0, k] - state[0], offset[1, k] - state[1]
            if abs(c0 * dx + s0 * dy) < blurs * state[4] or abs(c1 * dx + s1 * dy) < blurs * state[5]:
                kept[j, i] = True
                near[n] = k
                n += 1
            k += 1
    offsets, values = np.empty((2, n)), np.empty(n)
    for m in range(n):
        offsets[0, m], offsets[1, m], values[m] = offset[0, near[m]], offset[1, near[m]], value[near[m]]
    return kept, offsets, values
