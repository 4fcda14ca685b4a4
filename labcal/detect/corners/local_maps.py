"""Maps from the picture to the board around each corner, by the corners next to it."""

from dataclasses import dataclass

import numpy as np

from labcal.detect.corners.node_grid import NodeGrid, around
from labcal.detect.lattice.lattice import Node

_REACHES = (1, 2)
"""Nodes to either side that tell a map, the nearest that are enough."""
_TERMS = 6
"""Of a polynomial of second order in two variables."""
_MOST_VARIANCE = 4.0
"""Of the slopes of a map, in that of a corner a step: those of a corner amid others have 1/6."""


@dataclass(frozen=True)
class LocalMaps:
    """Maps of second order from offsets (px) to squares, around every corner.

    Attributes
    ----------
    linear : ndarray, shape (n, 2, 2)
        1/px; NaN where the corners around do not tell the map.
    square : ndarray, shape (n, 2, 3)
        Of ``x^2 / 2``, ``x y`` and ``y^2 / 2``, 1/px^2.
    weights : ndarray, shape (n, 5, k)
        Change of the coefficients by the place of each corner around, for a change of that by a square.
    """

    linear: np.ndarray
    square: np.ndarray
    weights: np.ndarray

    @property
    def known(self) -> np.ndarray:
        """Which corners have a map, shape (n,)."""
        return np.asarray(np.isfinite(self.linear[:, 0, 0]))


def local_maps(nodes: list[Node], places: np.ndarray) -> LocalMaps:
    """Return the maps around corners by least squares, from the 9 or up to 25 around each, itself included.

    Parameters
    ----------
    nodes : list of (col, row)
        At least one.
    places : ndarray, shape (n, 2)
        Px.
    """
    grid, count = NodeGrid.of(nodes), len(nodes)
    spread = grid.spread(np.concatenate([places, grid.nodes.astype(np.float64)], axis=1))
    linear, square = np.full((count, 2, 2), np.nan), np.full((count, 2, 3), np.nan)
    weights = np.zeros((count, _TERMS - 1, (2 * _REACHES[-1] + 1) ** 2))
    for reach in _REACHES:
        missing = np.flatnonzero(np.isnan(linear[:, 0, 0]))
        near = around(spread, reach)[:, *grid.at][:, missing]
        coefficients, gains = _fitted(near, places[missing], grid.nodes[missing])
        linear[missing], square[missing] = coefficients[..., 1:3], coefficients[..., 3:]
        weights[missing, :, : gains.shape[-1]] = gains
    return LocalMaps(linear, square, weights)


def _fitted(near: np.ndarray, places: np.ndarray, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return coefficients (n, 2, 6) and gains (n, 5, k) from places and nodes (k, n, 4); NaN if unknown."""
    known = np.isfinite(near[..., 0]).T
    away = np.where(known[..., None], np.moveaxis(near[..., :2] - places, 0, 1), 0.0)
    steps = np.where(known[..., None], np.moveaxis(near[..., 2:] - nodes, 0, 1), 0.0)
    scale = np.maximum(np.abs(away).max(axis=(1, 2)), 1.0)[:, None]
    x, y = np.moveaxis(away / scale[..., None], 2, 0)
    design = np.stack([np.ones_like(x), x, y, 0.5 * x * x, x * y, 0.5 * y * y], axis=-1) * known[..., None]
    coefficients = np.full((len(places), 2, _TERMS), np.nan)
    gains = np.zeros((len(places), _TERMS - 1, known.shape[1]))
    normal = np.einsum("nki,nkj->nij", design, design)
    enough = known.sum(axis=1) >= _TERMS
    enough[enough] = np.linalg.cond(normal[enough]) < 1e6
    if enough.any():
        gain = np.linalg.solve(normal[enough], np.moveaxis(design[enough], 1, 2))
        powers = scale[enough] ** -np.array([0.0, 1.0, 1.0, 2.0, 2.0, 2.0])
        gain = gain * powers[..., None]
        found = np.einsum("nck,nka->nac", gain, steps[enough])
        # Slopes over the size of a step: their variances are those of places over squares.
        per_step = np.linalg.norm(found[..., 1:3], axis=(1, 2)) / np.sqrt(2.0)
        certain = np.einsum("nck,nck->n", gain[:, 1:3], gain[:, 1:3]) / per_step**2 < _MOST_VARIANCE
        at = np.flatnonzero(enough)[certain]
        coefficients[at], gains[at] = found[certain], gain[certain, 1:]
    return coefficients, gains
