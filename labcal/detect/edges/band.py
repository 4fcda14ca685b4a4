"""The pixels from which a dot's edge is fitted: a band around the outline, away from what is no dot."""

from math import ceil, floor, sqrt

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.edges.edge_limits import EdgeLimits


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
    across = max(right - left + 1, 0)
    box = max(bottom - top + 1, 0) * across + 1  # with room for one that is not used
    pixels = np.empty((3, box))
    xs, ys, values = pixels[0], pixels[1], pixels[2]
    of_edge, of_flat = np.empty(across, dtype=np.int64), np.empty(across, dtype=np.int64)
    count, after = 0, box
    for y in range(top, bottom + 1):
        dy = y - state[1]
        for column in range(across):
            dx = left + column - state[0]
            u, v = a * dx + b * dy, b * dx + c * dy
            rho2 = u * u + v * v
            gx, gy = a * u + b * v, b * u + c * v
            # |distance| < width, without the roots of first order's (rho - 1) rho / |g|.
            near = (sqrt(rho2) - 1.0) ** 2 * rho2 < width * width * (gx * gx + gy * gy)
            used = (rho2 >= least) & (rho2 <= most)
            edge = used & (edge_least < rho2) & (rho2 < edge_most) & near
            of_edge[column] = edge
            of_flat[column] = used & ~edge & (flat_least <= rho2) & (rho2 <= flat_most)
        # A pixel is written to one of both ends, where the next one follows if it is used: without a branch.
        row = grey[y, left : left + across]
        for column in range(len(row)):
            at = count * of_edge[column] + (after - 1) * (1 - of_edge[column])
            xs[at], ys[at], values[at] = left + column, y, row[column]
            count += of_edge[column]
            after -= of_flat[column]
    band = np.empty((3, count + box - after))
    band[:, :count], band[:, count:] = pixels[:, :count], pixels[:, after:]
    return band, count


@compiled
def without_clutter(
    band: tuple[np.ndarray, int], found: np.ndarray, step: float, limits: EdgeLimits
) -> tuple[np.ndarray, int]:
    """Leave out what is neither dot nor board: dirt, glare, other marks, all away from the edge."""
    pixels, edge = band
    count, least = pixels.shape[1], limits.clutter_share * step
    suspect = False
    for k in range(count):
        if abs(found[0, k]) > least and abs(found[1, k]) > limits.near_flat_blurs:
            suspect = True
    if not suspect:
        return band
    size, away = np.abs(found[0]), np.abs(found[1]) > limits.near_flat_blurs
    clutter = (size > max(limits.clutter_sigma * 1.4826 * np.median(size), least)) & away
    keep = np.ones(count, dtype=np.bool_)
    for j in np.flatnonzero(clutter):
        near = np.maximum(np.abs(pixels[0] - pixels[0, j]), np.abs(pixels[1] - pixels[1, j]))
        keep &= ~((near <= limits.clutter_px) & away)
    return pixels[:, keep], int(keep[:edge].sum())
