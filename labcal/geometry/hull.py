"""Convex hulls of points that may lie on a line or in a plane."""

import numpy as np
from jaxtyping import Float64
from scipy.spatial import ConvexHull

from labcal.arrays import Mask

_FLAT = 1e-9
"""Spread, relative to the largest, below which points count as flat in a direction."""


def inside_hull(
    p: Float64[np.ndarray, "n 3"], hull_of: Float64[np.ndarray, "m 3"], tolerance_mm: float
) -> Mask:
    """Return a mask of points that lie in the convex hull of others, its border included.

    Parameters
    ----------
    p : ndarray, shape (n, 3)
        The points asked about, mm.
    hull_of : ndarray, shape (m, 3)
        The points that span the hull, mm; they may be coplanar or collinear.
    tolerance_mm : float
        How far outside still counts as inside.

    Returns
    -------
    ndarray of bool, shape (n,)
        False for NaN, and where nothing spans a hull.
    """
    if len(hull_of) == 0:
        return np.zeros(len(p), dtype=bool)
    centre = hull_of.mean(axis=0)
    _, spread, axes = np.linalg.svd(hull_of - centre, full_matrices=True)
    spread = np.concatenate([spread, np.zeros(3 - len(spread))])
    rank = int((spread > max(_FLAT * spread[0], tolerance_mm * 1e-3)).sum())
    local, spanned = (p - centre) @ axes.T, (hull_of - centre) @ axes.T
    inside = (np.abs(local[:, rank:]) <= tolerance_mm).all(axis=1)
    if rank == 1:
        inside &= (local[:, 0] >= spanned[:, 0].min() - tolerance_mm) & (
            local[:, 0] <= spanned[:, 0].max() + tolerance_mm
        )
    elif rank > 1:
        faces = ConvexHull(spanned[:, :rank]).equations
        distance = local[:, :rank] @ faces[:, :-1].T + faces[:, -1]
        inside &= (distance <= tolerance_mm).all(axis=1)
    return np.asarray(inside)


def hull_vertices(p: Float64[np.ndarray, "n k"], tolerance: float) -> Float64[np.ndarray, "m k"]:
    """Return the vertices of the convex hull of points, in the plane in order around it.

    Parameters
    ----------
    p : ndarray, shape (n, k)
        In two or three dimensions; points with NaN do not count.
    tolerance : float
        Extent below which points count as flat in a direction. Flat ones in space give the hull within their
        plane, those on a line its two ends.
    """
    p = p[np.isfinite(p).all(axis=1)]
    if len(p) <= 1:
        return p
    _, spread, axes = np.linalg.svd(p - p.mean(axis=0), full_matrices=True)
    local = (p - p.mean(axis=0)) @ axes.T
    rank = int((np.ptp(local[:, : len(spread)], axis=0) > tolerance).sum())
    if rank == 0:
        return p[:1]
    if rank == 1:
        return p[[int(np.argmin(local[:, 0])), int(np.argmax(local[:, 0]))]]
    return np.asarray(p[ConvexHull(local[:, :rank]).vertices])
