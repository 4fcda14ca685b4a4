"""The pixels from which a dot's edge is fitted: a band around the outline, away from what is no dot."""

from math import ceil, floor, sqrt

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.edges.edge_limits import EdgeLimits
from labcal.detect.medians import DEVIATIONS_A_MAD
from labcal.detect.row_products import copy_columns


@compiled
def pixels_around(
    grey: np.ndarray, state: np.ndarray, sizes: tuple[float, float], limits: EdgeLimits
) -> tuple[np.ndarray, int]:
    """Return x, y and value, shape (3, n), of the pixels around the outline, away from hole and other dots.

    The edge's pixels come first; how many these are is returned as well.
    """
    hole, reach = sizes
    a, b, c = state[2], state[3], state[4]
    xx, yy, xy = a * a + b * b, b * b + c * c, b * (a + c)
    determinant = xx * yy - xy * xy
    extent_x, extent_y = sqrt(yy / determinant), sqrt(xx / determinant)
    radius = determinant**-0.25
    width = limits.edge_blurs * state[5] + limits.edge_px
    # The distance changes with rho by no less than one over the largest slope, which bounds rho cheaply.
    wide = width * (0.5 * (a + c) + sqrt(0.25 * (a - c) ** 2 + b * b))
    flat = limits.band_blurs * state[5] / radius + max(limits.band_px / radius, limits.band_radii)
    nearest, farthest = max(1.0 - max(wide, flat), 0.0), min(1.0 + max(wide, flat), reach)
    if hole > 0.0:
        beside = hole + limits.hole_blurs * state[5] / min(extent_x, extent_y)
        nearest = max(nearest, min(beside, 0.5 * (1.0 + hole)))
    half_x, half_y = extent_x * farthest + 1.0, extent_y * farthest + 1.0
    height, columns = grey.shape
    left, right = max(floor(state[0] - half_x), 0), min(ceil(state[0] + half_x), columns - 1)
    top, bottom = max(floor(state[1] - half_y), 0), min(ceil(state[1] + half_y), height - 1)
    least, most = nearest**2, farthest**2
    edge_least, edge_most = max(1.0 - wide, 0.0) ** 2, (1.0 + wide) ** 2
    flat_least, flat_most = max(1.0 - flat, 0.0) ** 2, (1.0 + flat) ** 2
    some, among = _pixels_of_ring(grey, state, (least, most), (left, right, top, bottom))
    of_edge, of_flat = np.empty(among, dtype=np.int64), np.empty(among, dtype=np.int64)
    x_row, y_row = some[0], some[1]
    for k in range(among):
        dx, dy = x_row[k] - state[0], y_row[k] - state[1]
        u, v = a * dx + b * dy, b * dx + c * dy
        rho2 = u * u + v * v
        gx, gy = a * u + b * v, b * u + c * v
        # |distance| < width, without the roots of first order's (rho - 1) rho / |g|.
        near = (sqrt(rho2) - 1.0) ** 2 * rho2 < width * width * (gx * gx + gy * gy)
        used = (rho2 >= least) & (rho2 <= most)
        edge = used & (edge_least < rho2) & (rho2 < edge_most) & near
        of_edge[k] = edge
        of_flat[k] = used & ~edge & (flat_least <= rho2) & (rho2 <= flat_most)
    return _sorted(some, of_edge, of_flat)


@compiled
def _pixels_of_ring(
    grey: np.ndarray, state: np.ndarray, squares: tuple[float, float], box: tuple[int, int, int, int]
) -> tuple[np.ndarray, int]:
    """Return x, y, value, (3, m), of the pixels in a box between two ellipses and some more; their number.

    The ellipses are the outline, larger and smaller: with the squares of its flattened radius.
    """
    a, b, c = state[2], state[3], state[4]
    xx, xy = a * a + b * b, b * (a + c)
    determinant = (a * c - b * b) ** 2
    left, right, top, bottom = box
    some, among = np.empty((3, max(bottom - top + 1, 0) * max(right - left + 1, 0))), 0
    for y in range(top, bottom + 1):
        dy = y - state[1]
        # Of a row, what lies within the larger one and beyond the smaller one, and a pixel more.
        middle, apart = state[0] - xy * dy / xx, determinant * dy * dy
        outer = sqrt(max(squares[1] * xx - apart, 0.0)) / xx + 1.0
        inner = max(sqrt(max(squares[0] * xx - apart, 0.0)) / xx - 1.0, 0.0)
        first, last = max(floor(middle - outer), left), min(ceil(middle + outer), right)
        hole_from, hole_to = max(ceil(middle - inner), first), min(floor(middle + inner), last)
        if hole_from < hole_to:
            among = _add_row(grey, some, among, y, (first, hole_from))
            first = hole_to
        among = _add_row(grey, some, among, y, (first, last))
    return some, among


@compiled
def _sorted(some: np.ndarray, of_edge: np.ndarray, of_flat: np.ndarray) -> tuple[np.ndarray, int]:
    """Return the pixels of the edge and then the flat ones, shape (3, n), and the number of the former."""
    among = len(of_edge)
    pixels = np.empty((3, among + 1))  # with room for one that is not used
    x_row, y_row, value_row = some[0], some[1], some[2]
    xs, ys, values = pixels[0], pixels[1], pixels[2]
    count, after = 0, among + 1
    for k in range(among):
        # A pixel is written to one of both ends, where the next one follows if it is used: without a branch.
        at = count * of_edge[k] + (after - 1) * (1 - of_edge[k])
        xs[at], ys[at], values[at] = x_row[k], y_row[k], value_row[k]
        count += of_edge[k]
        after -= of_flat[k]
    band = np.empty((3, count + among + 1 - after))
    copy_columns(pixels, 0, band, (0, count))
    copy_columns(pixels, after, band, (count, among + 1 - after))
    return band, count


@compiled
def _add_row(grey: np.ndarray, some: np.ndarray, among: int, y: int, columns: tuple[int, int]) -> int:
    """Add the pixels of a row, both columns among them, behind the first ones; return how many there are."""
    first, count = columns[0], max(columns[1] - columns[0] + 1, 0)
    xs, ys, values = some[0, among:], some[1, among:], some[2, among:]
    row = grey[y, first : first + count]
    for k in range(count):
        xs[k], ys[k], values[k] = first + k, y, row[k]
    return among + count


@compiled
def without_clutter(
    band: tuple[np.ndarray, int], found: np.ndarray, step: float, limits: EdgeLimits
) -> tuple[np.ndarray, int]:
    """Leave out what is neither dot nor board: dirt, glare, other marks, all away from the edge."""
    pixels, edge = band
    count, least = pixels.shape[1], limits.clutter_share * step
    residual, from_edge, suspects = found[0], found[1], 0
    for k in range(count):
        suspects += (abs(residual[k]) > least) & (abs(from_edge[k]) > limits.near_flat_blurs)
    if suspects == 0:
        return band
    size, away = np.abs(found[0]), np.abs(found[1]) > limits.near_flat_blurs
    clutter = (size > max(limits.clutter_sigma * DEVIATIONS_A_MAD * np.median(size), least)) & away
    keep = np.ones(count, dtype=np.bool_)
    for j in np.flatnonzero(clutter):
        near = np.maximum(np.abs(pixels[0] - pixels[0, j]), np.abs(pixels[1] - pixels[1, j]))
        keep &= ~((near <= limits.clutter_px) & away)
    return pixels[:, keep], int(keep[:edge].sum())
