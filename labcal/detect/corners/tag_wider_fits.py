"""Second fit of the corners of tags: along all of their edges, whose bend the corners beside them tell."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from labcal.detect.corners.corner_fit import SettledCorner
from labcal.detect.corners.corner_kernel import LIGHT_KNOWN
from labcal.detect.corners.edge_bends import across_edges
from labcal.detect.corners.known_light import light_slopes
from labcal.detect.corners.node_grid import NodeGrid, median_around
from labcal.detect.corners.tag_saddle import TagSaddle, widened_tag_saddle
from labcal.detect.corners.tag_tone import fits_by_tone
from labcal.detect.grey import GreyPicture
from labcal.detect.lattice.lattice import Node
from labcal.detect.stage_settings.corner import CornerSettings

_NEAR = 1
"""Nodes to either side whose curvatures have one median, against the corners' noise."""
_LINE_NODES, _FEWEST_ON_LINE = 2, 4
"""Nodes to either side that tell the curvature of a line, and the fewest that do."""
_LIGHT_NODES, _FEWEST = (2,), 6
"""Nodes to either side whose white levels tell the slope of the light, and the fewest that do."""


def wider_tag_fits(
    grey: GreyPicture,
    fits: Mapping[Node, SettledCorner],
    saddles: Mapping[Node, TagSaddle],
    settings: CornerSettings,
) -> dict[Node, SettledCorner]:
    """Return the fits of corners over all of their edges that no other corner shares.

    As :func:`labcal.detect.corners.wider_fits.wider_fits` of chessboards, with two differences. Corners are
    not evenly spaced, and near ones tell little of a curvature: it is that of a parabola through up to five
    corners of a line. The slope of the light is that of the logarithm of the white level around.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    fits : mapping of (col, row) to SettledCorner
        The first fits.
    saddles : mapping of (col, row) to TagSaddle
        With which they were made.
    settings : CornerSettings

    Returns
    -------
    dict of (col, row) to SettledCorner
        With the first fit where too few corners are around; without those whose second fit does not converge.
    """
    if not fits:
        return {}
    bends = _bends(fits)
    wide: dict[Node, SettledCorner] = {}
    for k, (node, fit) in enumerate(fits.items()):
        if np.isnan(bends[k]).any():
            continue
        corner = replace(saddles[node], centre=fit.centre)
        found = widened_tag_saddle(grey, corner, bends[k], fit.state, settings)
        if found is not None:
            wide[node] = found
    final = {node: fit for k, (node, fit) in enumerate(fits.items()) if np.isnan(bends[k]).any()}
    if not wide:
        return fits_by_tone(final, settings)
    grid, places = NodeGrid.of(list(wide)), np.array([one.centre for one in wide.values()])
    white = np.array([one.state[6] + one.state[7] for one in wide.values()])
    slopes = light_slopes(grid, places, np.where(white > 0.0, white, np.nan), (_LIGHT_NODES, _FEWEST))
    for (node, one), slope, bend in zip(wide.items(), slopes, _bends(wide), strict=True):
        known = not np.isnan(bend).any() and not np.isnan(slope).any()
        final[node] = _with_light(one, slope, bend) if known else fits[node]
    return fits_by_tone(final, settings)


def _with_light(wide: SettledCorner, slope: np.ndarray, bend: np.ndarray) -> SettledCorner:
    """Return a fit, not converged, with slope of the light and bend of its edges as they are known."""
    state = wide.state.copy()
    # The model's light is 1 where the fit began: the slope at the corner is over the level there.
    state[8:] = slope / (1.0 - slope @ state[:2])
    return replace(wide, state=state, pixels=replace(wide.window, bend=bend), free=LIGHT_KNOWN)


def _bends(fits: Mapping[Node, SettledCorner]) -> np.ndarray:
    """Return how much the edges of fits bend towards their normals, 1/px, shape (n, 2); NaN if unknown."""
    grid, places = NodeGrid.of(list(fits)), np.array([fit.centre for fit in fits.values()])
    states = np.array([fit.state for fit in fits.values()])
    spread = grid.spread(places)
    bends = np.stack([median_around(_curvatures(spread, axis), _NEAR) for axis in (0, 1)], axis=2)[grid.at]
    return across_edges(bends, states)


def _curvatures(places: np.ndarray, axis: int) -> np.ndarray:
    """Return vectors of curvature of the lines along one axis at places (a, b, 2), 1/px; NaN if unknown.

    By least squares, ``c0 + c1 s + c2 s^2 / 2`` across the line against the length s along it.
    """
    pad = [(0, 0)] * 3
    pad[axis] = (_LINE_NODES, _LINE_NODES)
    padded, length = np.pad(places, pad, constant_values=np.nan), places.shape[axis]
    steps = np.arange(-_LINE_NODES, _LINE_NODES + 1)
    away = np.stack(
        [np.take(padded, np.arange(k + _LINE_NODES, k + _LINE_NODES + length), axis) - places for k in steps]
    )
    known = np.isfinite(away[..., 0])
    away = np.where(known[..., None], away, 0.0)
    along = np.einsum("k,kabi->abi", steps, away)
    size = np.linalg.norm(along, axis=-1, keepdims=True)
    enough = (known.sum(axis=0) >= _FEWEST_ON_LINE) & (size[..., 0] > 0.0)
    along = along / np.where(size > 0.0, size, 1.0)
    s = (away * along).sum(axis=-1)
    scale = np.maximum(np.abs(s).max(axis=0), 1.0)
    normal = np.stack([-along[..., 1], along[..., 0]], axis=-1)
    across = (away * normal).sum(axis=-1)
    t = s / scale
    design = np.stack([np.ones_like(t), t, 0.5 * t * t], axis=-1) * known[..., None]
    bend = np.full(places.shape[:2], np.nan)
    gram = np.einsum("kabi,kabj->abij", design, design)[enough]
    if len(gram):
        right = np.einsum("kabi,kab->abi", design, across)[enough]
        bend[enough] = np.linalg.solve(gram, right[..., None])[:, 2, 0] / scale[enough] ** 2
    return np.asarray(normal * bend[..., None])
