"""The pixels of many corners, one after the other in flat arrays, for compiled code."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.corners.corner_kernel import CHESSBOARD, Pixels
from labcal.detect.corners.corner_model import CornerPixels

Window = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
"""Mask, offsets, values and gap, see :class:`~labcal.detect.corners.corner_model.CornerPixels`."""


class PackedPixels(NamedTuple):
    """Pixels of n corners.

    Attributes
    ----------
    ends : ndarray of int, shape (n + 1, 2)
        Where each corner's pixels, and its mask, begin; the last row is where all end.
    shape : ndarray of int, shape (n, 2)
        Of the masks.
    mask : ndarray of bool, shape (m,)
    offset : ndarray, shape (2 N,)
        Of each corner all x, then all y.
    value : ndarray, shape (N,)
    gap : ndarray, shape (n, 2)
    """

    ends: np.ndarray
    shape: np.ndarray
    mask: np.ndarray
    offset: np.ndarray
    value: np.ndarray
    gap: np.ndarray


@compiled
def packed(windows: Sequence[Window]) -> PackedPixels:
    """Return the windows of corners in flat arrays."""
    n = len(windows)
    ends, shape, gap = (
        np.zeros((n + 1, 2), dtype=np.int64),
        np.empty((n, 2), dtype=np.int64),
        np.empty((n, 2)),
    )
    for k in range(n):
        ends[k + 1, 0] = ends[k, 0] + len(windows[k][2])
        ends[k + 1, 1] = ends[k, 1] + windows[k][0].size
    mask, offset, value = np.empty(ends[n, 1], dtype=np.bool_), np.empty(2 * ends[n, 0]), np.empty(ends[n, 0])
    for k in range(n):
        own, offsets, values, gaps = windows[k]
        first, last = ends[k, 0], ends[k + 1, 0]
        shape[k, 0], shape[k, 1] = own.shape
        gap[k] = gaps
        flat, here, there = own.ravel(), mask[ends[k, 1] : ends[k + 1, 1]], value[first:last]
        xs, ys = offset[2 * first : first + last], offset[first + last : 2 * last]
        # Element by element: assignment of slices takes longer than that.
        for j in range(len(here)):
            here[j] = flat[j]
        for j in range(len(there)):
            xs[j], ys[j], there[j] = offsets[0, j], offsets[1, j], values[j]
    return PackedPixels(ends, shape, mask, offset, value, gap)


@compiled
def pixels_of(all_: PackedPixels, k: int, bend: np.ndarray, pattern: int, tone: float) -> Pixels:
    """Return the pixels of one corner."""
    first, last = all_.ends[k, 0], all_.ends[k + 1, 0]
    offset = all_.offset[2 * first : 2 * last].reshape(2, last - first)
    return offset, all_.value[first:last], all_.gap[k], bend, pattern, tone


@compiled
def mask_of(all_: PackedPixels, k: int) -> np.ndarray:
    """Return the mask of one corner, shape (h, w)."""
    high, wide = all_.shape[k]
    return all_.mask[all_.ends[k, 1] : all_.ends[k + 1, 1]].reshape(high, wide)


def pack(windows: Sequence[CornerPixels]) -> PackedPixels:
    """Return the pixels of corners in flat arrays."""
    sizes = np.array([(one.value.size, one.mask.size) for one in windows], dtype=np.int64).reshape(-1, 2)
    return PackedPixels(
        ends=np.concatenate([np.zeros((1, 2), dtype=np.int64), sizes.cumsum(axis=0)]),
        shape=np.array([one.mask.shape for one in windows], dtype=np.int64).reshape(-1, 2),
        mask=np.concatenate([one.mask.ravel() for one in windows]),
        offset=np.concatenate([one.offset.ravel() for one in windows]),
        value=np.concatenate([one.value for one in windows]),
        gap=np.array([one.gap for one in windows]),
    )


class PackedCorner(NamedTuple):
    """The pixels of a corner among those of many, to be taken out where somebody wants them.

    Attributes
    ----------
    all_ : PackedPixels
    number : int
        Of the corner.
    bend : ndarray, shape (2,)
    pattern : int
    tone : float
        All as of :class:`~labcal.detect.corners.corner_model.CornerPixels`.
    """

    all_: PackedPixels
    number: int
    bend: np.ndarray
    pattern: int = CHESSBOARD
    tone: float = 0.0

    def unpacked(self) -> CornerPixels:
        """Return the pixels, as views."""
        all_, k = self.all_, self.number
        (first, at), (last, end) = all_.ends[k].tolist(), all_.ends[k + 1].tolist()
        mask = all_.mask[at:end].reshape(all_.shape[k].tolist())
        offset, value = all_.offset[2 * first : 2 * last].reshape(2, -1), all_.value[first:last]
        return CornerPixels(mask, offset, value, all_.gap[k], self.pattern, self.bend, self.tone)
