"""The slope of the light that the white levels of the corners around a corner tell."""

import numpy as np

from labcal.detect.corners.node_grid import NodeGrid, around
from labcal.detect.medians import DEVIATIONS_A_MAD

_FLAT = 1e-6
"""Least determinant of the normal equations, scaled, of nodes that are not on one line."""
_LEAST_LEFT = 0.002
"""Of a level's logarithm: what noise and a curve of the light leave."""
_FAR_OFF = 3.0
"""Of what planes leave, in the usual: such a level is not one of the board alone."""
_ROUGH = 0.01
"""And usually, of a level's logarithm: one level may have turned the plane through few."""
_ROUNDS = 8
"""Fits with weights."""


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
    """Return slopes at corners (n, 2) from the places and levels (k, n, 3) near each; NaN for too few.

    A level that is far off, of a corner at which something covers the board, hardly counts: where there are
    such levels, planes are fitted with the weights of Cauchy's distribution.
    """
    known = np.isfinite(near[..., 2])
    away = np.where(known[..., None], near[..., :2] - places, 0.0)
    scale = np.maximum(np.abs(away).max(axis=(0, 2)), 1.0)
    design = np.concatenate([known[..., None].astype(np.float64), away / scale[:, None]], axis=-1)
    level = np.where(known, near[..., 2], 0.0)
    planes = _planes(design, level, known.astype(np.float64))
    planes[known.sum(axis=0) < fewest] = np.nan
    left, usual = _left(design, level, known, planes)
    off = (left > _FAR_OFF * usual).any(axis=0) | (usual > _ROUGH)
    doubtful = np.flatnonzero(off & np.isfinite(planes[:, 0]))
    if len(doubtful):
        own = design[:, doubtful], level[:, doubtful], known[:, doubtful]
        left, usual = left[:, doubtful], usual[doubtful]
        for _ in range(_ROUNDS):
            planes[doubtful] = _planes(*own[:2], own[2] / (1.0 + (left / usual) ** 2))
            left, usual = _left(*own, planes[doubtful])
    return np.asarray(planes[:, 1:] / scale[:, None])


def _planes(design: np.ndarray, level: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Return level and slopes (n, 3) by weighted least squares; NaN where places are on one line."""
    weighted = design * weight[..., None]
    normal = np.einsum("kni,knj->nij", weighted, design)
    right = np.einsum("kni,kn->ni", weighted, level)
    size = np.maximum(normal[:, :1, :1], _FLAT)
    enough = np.linalg.det(normal / size) > _FLAT
    planes = np.full(right.shape, np.nan)
    if enough.any():
        planes[enough] = np.linalg.solve(normal[enough], right[enough][..., None])[..., 0]
    return planes


def _left(
    design: np.ndarray, level: np.ndarray, known: np.ndarray, planes: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the sizes of what planes leave of levels (k, n), and the usual size of each plane (n,)."""
    left = np.abs(level - np.einsum("kni,ni->kn", design, planes))
    ordered = np.sort(np.where(known, left, np.inf), axis=0)
    middle = np.take_along_axis(ordered, (known.sum(axis=0) // 2)[None], axis=0)[0]
    return np.where(known, left, 0.0), np.maximum(DEVIATIONS_A_MAD * middle, _LEAST_LEFT)
