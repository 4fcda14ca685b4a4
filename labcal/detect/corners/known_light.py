"""The slope of the light that the white levels of the corners around a corner tell."""

import numpy as np

from labcal.detect.corners.node_grid import NodeGrid, around

_FLAT = 1e-6
"""Least determinant of the normal equations, scaled, of nodes that are not on one line."""


def light_slopes(
    grid: NodeGrid, places: np.ndarray, white: np.ndarray, near: tuple[tuple[int, ...], int]
) -> np.ndarray:
    """Return the slope of the light at corners, 1/px, shape (n, 2): that of the white level around each.

    It is the slope of the level's logarithm, by which light far from even falls in a straight line: a corner
    at the rim of the board has the others on one side only. NaN where there are too few corners around, or
    all on one line.

    Parameters
    ----------
    grid : NodeGrid
        Of the corners.
    places : ndarray, shape (n, 2)
        Px.
    white : ndarray, shape (n,)
        Grey values above 0; NaN for none.
    near : (tuple of int, int)
        Nodes to either side that tell a slope, the nearest first: those that are enough; and the fewest.
    """
    reaches, fewest = near
    levels = grid.spread(np.concatenate([places, np.log(white)[:, None]], axis=1))
    slopes = np.full((len(places), 2), np.nan)
    for reach in reaches:
        missing = np.isnan(slopes[:, 0])
        if missing.any():
            found = around(levels, reach)[:, *grid.at]
            slopes[missing] = _slopes_of(found[:, missing], places[missing], fewest)
    return slopes


def _slopes_of(near: np.ndarray, places: np.ndarray, fewest: int) -> np.ndarray:
    """Return slopes at corners (n, 2) from the places and levels (k, n, 3) near each; NaN for too few."""
    known = np.isfinite(near[..., 2])
    away = np.where(known[..., None], near[..., :2] - places, 0.0)
    scale = np.maximum(np.abs(away).max(axis=(0, 2)), 1.0)
    design = np.concatenate([known[..., None].astype(np.float64), away / scale[:, None]], axis=-1)
    normal = np.einsum("kni,knj->nij", design, design)
    right = np.einsum("kni,kn->ni", design, np.where(known, near[..., 2], 0.0))
    enough = (known.sum(axis=0) >= fewest) & (np.linalg.det(normal) > _FLAT)
    slopes = np.full((len(places), 2), np.nan)
    if enough.any():
        slopes[enough] = np.linalg.solve(normal[enough], right[enough][..., None])[:, 1:, 0]
    return np.asarray(slopes / scale[:, None])
