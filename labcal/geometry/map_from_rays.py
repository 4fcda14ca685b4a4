"""The linear map from points to the directions in which they are seen, by least squares."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

_OPEN = 1e-14
"""Second least over largest eigenvalue below which points leave the map open."""


@dataclass(frozen=True)
class RayMap:
    """A map from points to directions, known up to a positive factor.

    Attributes
    ----------
    linear : float64 array, (3, dim + 1)
        From ((p - middle) / scale, 1), the factor such that points lie ahead.
    middle : float64 array, (dim,)
        Of the points, mm.
    scale : float
        Mm.
    is_open : bool
        Whether other maps do as well: the points are in a degenerate arrangement.
    """

    linear: Float64[np.ndarray, "3 dim1"]
    middle: Float64[np.ndarray, " dim"]
    scale: float
    is_open: bool


def map_from_rays(directions: Float64[np.ndarray, "n 3"], p: Float64[np.ndarray, "n dim"]) -> RayMap:
    """Return the map with the least cross products between mapped points and their directions.

    Parameters
    ----------
    directions : ndarray, shape (n, 3)
        Unit directions.
    p : ndarray, shape (n, dim)
        Points of a plane or of space, mm.

    Notes
    -----
    The direct linear transform with directions in the place of pixels, by its normal matrix: with a unit
    vector v, ``[v]x' [v]x`` is ``1 - v v'``.
    """
    middle = p.mean(axis=0)
    scale = float(np.sqrt(((p - middle) ** 2).sum(axis=1).mean())) or 1.0
    normalised = np.column_stack([(p - middle) / scale, np.ones(len(p))])
    width = normalised.shape[1]
    along = (directions[:, :, None] * normalised[:, None, :]).reshape(-1, 3 * width)
    normal = -along.T @ along
    for axis in range(3):
        block = slice(width * axis, width * (axis + 1))
        normal[block, block] += normalised.T @ normalised
    square, axes = np.linalg.eigh(normal)
    linear = axes[:, 0].reshape(3, width)
    linear = linear * np.sign((directions * (normalised @ linear.T)).sum())
    return RayMap(linear, middle, scale, bool(square[1] <= _OPEN * square[-1]))
