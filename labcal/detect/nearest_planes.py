"""Planes through the levels of the nearest places around every place, compiled."""

import numpy as np

from labcal.detect.compiled import compiled


@compiled
def nearest_planes(
    place: np.ndarray, level: np.ndarray, count: int, most_oblong: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return slopes of planes through levels by least squares, and the sums of the slopes' two variances.

    Parameters
    ----------
    place : ndarray, shape (n, 2)
    level : ndarray, shape (n,)
    count : int
        So many nearest places belong to a plane, its own among them; 4 to n.
    most_oblong : float
        Least determinant, over the squared trace, of the places' scatter: with less the variance is infinite.

    Returns
    -------
    slopes : ndarray, shape (n, 2)
    variance : ndarray, shape (n,)
    """
    slopes, variance = np.zeros((len(place), 2)), np.full(len(place), np.inf)
    near, far = np.empty(count, dtype=np.int64), np.empty(count)
    for i in range(len(place)):
        _write_nearest(place, i, near, far)
        x, y, z = 0.0, 0.0, 0.0
        for k in near:
            x, y, z = x + place[k, 0], y + place[k, 1], z + level[k]
        x, y, z = x / count, y / count, z / count
        xx, xy, yy, xz, yz, zz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for k in near:
            dx, dy, dz = place[k, 0] - x, place[k, 1] - y, level[k] - z
            xx, xy, yy = xx + dx * dx, xy + dx * dy, yy + dy * dy
            xz, yz, zz = xz + dx * dz, yz + dy * dz, zz + dz * dz
        determinant, trace = xx * yy - xy * xy, xx + yy
        if not determinant > most_oblong * trace * trace:
            continue
        u, v = (yy * xz - xy * yz) / determinant, (xx * yz - xy * xz) / determinant
        slopes[i, 0], slopes[i, 1] = u, v
        left = max(zz - u * xz - v * yz, 0.0)
        variance[i] = left / (count - 3) * trace / determinant
    return slopes, variance


@compiled
def _write_nearest(place: np.ndarray, i: int, near: np.ndarray, far: np.ndarray) -> None:
    """Write the numbers of the places nearest to place i, and their squared distances, nearest first."""
    known, count = 0, len(near)
    for k in range(len(place)):
        dx, dy = place[k, 0] - place[i, 0], place[k, 1] - place[i, 1]
        squared = dx * dx + dy * dy
        if known == count and not squared < far[count - 1]:
            continue
        at = min(known, count - 1)
        while at > 0 and far[at - 1] > squared:
            near[at], far[at] = near[at - 1], far[at - 1]
            at -= 1
        near[at], far[at] = k, squared
        known = min(known + 1, count)
