"""Pixels of the fit of a tag's corner on an AprilGrid: along the four edges that meet, in compiled code."""

from math import hypot
from typing import NamedTuple

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.corners.corner_window import pixel_box

_LEAST_WHITE = 0.3
"""Share of the white space beside a tag that counts in any case."""


class TagForm(NamedTuple):
    """The parts of a tag's print that say which pixels are a corner's own."""

    gap: float
    """Side of the small square, in tags."""
    border: float
    """Width of the tag's black border, in tags."""
    share: float
    """Reach along each edge, of the distance to the next corner on it."""
    reach: float
    """Farthest pixel, px."""


@compiled
def tag_heights(edges: np.ndarray) -> tuple[float, float]:
    """Return the distances of a tag's corners from its opposite edges, px: along the first edge, the second.

    `edges` (2, 2) holds in its columns the ways from the corner to the next corners.
    """
    area = abs(edges[0, 0] * edges[1, 1] - edges[0, 1] * edges[1, 0])
    return area / hypot(edges[0, 1], edges[1, 1]), area / hypot(edges[0, 0], edges[1, 0])


@compiled
def tag_pixels(
    grey: np.ndarray, place: tuple[np.ndarray, np.ndarray], form: TagForm, guard_px: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return mask, offsets and values of :class:`~labcal.detect.corners.corner_model.CornerPixels`.

    `place` holds the corner's centre and the tag's edges, in columns. `guard_px` is the distance kept from
    the tag's cells, and from the next tag across the white space. No pixel lies beyond the middle of that
    space, or of an edge.
    """
    centre, edges = place
    x, y = centre[0], centre[1]
    det = edges[0, 0] * edges[1, 1] - edges[0, 1] * edges[1, 0]
    first, second = tag_heights(edges)
    inner_first, inner_second = form.border - guard_px / first, form.border - guard_px / second
    most = form.share * form.gap
    least_first = -max(min(most, form.gap - guard_px / first), _LEAST_WHITE * form.gap)
    least_second = -max(min(most, form.gap - guard_px / second), _LEAST_WHITE * form.gap)
    across = min(form.reach, form.share * (abs(edges[0, 0]) + abs(edges[0, 1])))
    down = min(form.reach, form.share * (abs(edges[1, 0]) + abs(edges[1, 1])))
    left, top, wide, high = pixel_box(grey.shape, centre, across, down)
    mask = np.zeros((high, wide), dtype=np.bool_)
    offset, value = np.empty((2, high * wide)), np.empty(high * wide)
    n = 0
    for j in range(high):
        for i in range(wide):
            dx, dy = left + i - x, top + j - y
            a = (edges[1, 1] * dx - edges[0, 1] * dy) / det
            b = (edges[0, 0] * dy - edges[1, 0] * dx) / det
            if (
                a <= least_first
                or b <= least_second
                or max(a, b) >= form.share
                or hypot(dx, dy) >= form.reach
            ):
                continue
            if a > inner_first and b > inner_second:
                continue
            mask[j, i] = True
            offset[0, n], offset[1, n], value[n] = dx, dy, grey[top + j, left + i]
            n += 1
    return mask, offset[:, :n].copy(), value[:n].copy()
