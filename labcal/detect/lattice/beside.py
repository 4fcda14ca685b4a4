"""Shapes in steps of a grid, numbers of neighbours, and nodes and spots beside each other, compiled."""

from math import sqrt

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.matrices import geometric_means, inverses, matrix_roots

_NEAR = 2
"""Nodes to either side whose spots are a node's neighbours."""


@compiled
def shapes_by_steps(predictions: np.ndarray, shape: np.ndarray, spots: np.ndarray) -> np.ndarray:
    """Return the outline matrices of spots in units of the grid's steps, (n, 2, 2).

    NaN where a node has no prediction.
    """
    found = np.full((len(predictions), 2, 2), np.nan)
    for k in range(len(predictions)):
        p, r, q, s = predictions[k, 2], predictions[k, 3], predictions[k, 4], predictions[k, 5]
        if not np.isfinite(predictions[k, 0]):
            continue
        d = p * s - q * r
        a, b, c, e = s / d, -q / d, -r / d, p / d  # the inverse of the steps, which are columns
        S = shape[spots[k]]
        xx, xy = a * S[0, 0] + b * S[1, 0], a * S[0, 1] + b * S[1, 1]
        yx, yy = c * S[0, 0] + e * S[1, 0], c * S[0, 1] + e * S[1, 1]
        found[k, 0, 0], found[k, 0, 1] = xx * a + xy * b, xx * c + xy * e
        found[k, 1, 0], found[k, 1, 1] = yx * a + yy * b, yx * c + yy * e
    return found


@compiled
def neighbour_counts(grid: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return how many nodes with a spot lie within two steps of places (n, 2) in a grid."""
    found = np.zeros(len(places), dtype=np.int64)
    for k in range(len(places)):
        a, b = places[k]
        for i in range(max(a - _NEAR, 0), min(a + _NEAR + 1, grid.shape[0])):
            for j in range(max(b - _NEAR, 0), min(b + _NEAR + 1, grid.shape[1])):
                found[k] += grid[i, j] >= 0 and not (i == a and j == b)
    return found


@compiled
def empty_beside(nodes: np.ndarray) -> np.ndarray:
    """Return the nodes (m, 2) next to some others (n, 2), sorted."""
    low_a, low_b = nodes[:, 0].min() - 1, nodes[:, 1].min() - 1
    rows, columns = nodes[:, 0].max() - low_a + 2, nodes[:, 1].max() - low_b + 2
    near = np.zeros((rows, columns), dtype=np.int8)
    for k in range(len(nodes)):
        a, b = nodes[k, 0] - low_a, nodes[k, 1] - low_b
        near[a - 1 : a + 2, b - 1 : b + 2] |= 1
        near[a, b] |= 2
    found, count = np.empty((rows * columns, 2), dtype=np.int64), 0
    for a in range(rows):
        for b in range(columns):
            if near[a, b] == 1:
                found[count, 0], found[count, 1] = a + low_a, b + low_b
                count += 1
    return found[:count].copy()


@compiled
def nearest_alike(
    position: np.ndarray,
    shape: np.ndarray,
    blobs: tuple[np.ndarray, np.ndarray, np.ndarray],
    limits: tuple[float, float],
) -> np.ndarray:
    """Return the whole spots of about the right size at places of dots (n, 2), (n, 2, 2); -1 for none.

    Spots are centres, outline matrices, and whether the frame cuts them. Limits are the most that the
    logarithm of the radius may differ, and the place, in radii.
    """
    centre, outline, cut = blobs
    found, size = np.full(len(position), -1), np.empty(len(centre))
    for j in range(len(centre)):
        size[j] = sqrt(sqrt(outline[j, 0, 0] * outline[j, 1, 1] - outline[j, 0, 1] * outline[j, 1, 0]))
    for k in range(len(position)):
        radius = sqrt(sqrt(shape[k, 0, 0] * shape[k, 1, 1] - shape[k, 0, 1] * shape[k, 1, 0]))
        best, least = -1, np.inf
        for j in range(len(centre)):
            x, y = centre[j, 0] - position[k, 0], centre[j, 1] - position[k, 1]
            away = sqrt(x * x + y * y) / radius
            if cut[j] or away >= least or away > limits[1]:
                continue
            if abs(np.log(size[j] / radius)) <= limits[0]:
                best, least = j, away
        found[k] = best
    return found


@compiled
def distance_to_nearest(places: np.ndarray, taken: np.ndarray) -> np.ndarray:
    """Return the distances (n) of places (n, 2) from the nearest of some others, (m, 2)."""
    found = np.empty(len(places))
    for k in range(len(places)):
        least = np.inf
        for j in range(len(taken)):
            least = min(least, (taken[j, 0] - places[k, 0]) ** 2 + (taken[j, 1] - places[k, 1]) ** 2)
        found[k] = sqrt(least)
    return found


@compiled
def step_lengths(
    nodes: np.ndarray, spots: np.ndarray, centre: np.ndarray, shape: np.ndarray, step: tuple[int, int]
) -> np.ndarray:
    """Return the lengths of a lattice's steps of one kind, by its nodes' order, in units of the ellipses.

    A step is measured by the geometric mean of the flattening maps at its ends.
    """
    low_a, low_b = nodes[:, 0].min(), nodes[:, 1].min()
    rows, columns = nodes[:, 0].max() - low_a + 1, nodes[:, 1].max() - low_b + 1
    grid = np.full((rows, columns), -1)
    for k in range(len(nodes)):
        grid[nodes[k, 0] - low_a, nodes[k, 1] - low_b] = spots[k]
    flatten = inverses(matrix_roots(shape))
    here, there, count = np.empty(len(nodes), dtype=np.int64), np.empty(len(nodes), dtype=np.int64), 0
    for k in range(len(nodes)):
        a, b = nodes[k, 0] - low_a + step[0], nodes[k, 1] - low_b + step[1]
        if a < rows and b < columns and grid[a, b] >= 0:
            here[count], there[count] = spots[k], grid[a, b]
            count += 1
    between = geometric_means(flatten[here[:count]], flatten[there[:count]])
    found = np.empty(count)
    for k in range(count):
        x, y = centre[there[k], 0] - centre[here[k], 0], centre[there[k], 1] - centre[here[k], 1]
        u, v = between[k, 0, 0] * x + between[k, 0, 1] * y, between[k, 1, 0] * x + between[k, 1, 1] * y
        found[k] = sqrt(u * u + v * v)
    return found
