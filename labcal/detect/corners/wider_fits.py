"""Second fit of the corners of a board: to the middles of the squares, along edges whose bend is known."""

from dataclasses import replace

import numpy as np

from labcal.detect.corners.corner_fit import SettledCorner, widen
from labcal.detect.corners.corner_window import Surroundings
from labcal.detect.corners.edge_bends import across_edges, edge_bends
from labcal.detect.corners.known_light import known_light_fits, light_slopes
from labcal.detect.corners.node_grid import NodeGrid, ahead, behind, median_around
from labcal.detect.grey import GreyPicture
from labcal.detect.lattice.lattice import Node
from labcal.detect.stage_settings.corner import CornerSettings

_LIGHT_NODES = (1, 2, 4)
"""Nodes to either side whose white levels tell the slope of the light: the nearest that are enough."""
_FEWEST = 5
_DARKEST = 1e-3
"""Of white, grey values."""
_ROUGH_NODES = 2
"""Nodes to either side whose residuals are the usual ones."""


def wider_fits(
    grey: GreyPicture,
    fits: dict[Node, SettledCorner],
    surroundings: dict[Node, Surroundings],
    settings: CornerSettings,
) -> dict[Node, SettledCorner]:
    """Return the fits of corners over all of their edges that no other corner shares.

    A first fit keeps so near to its corner that no lens bends an edge by more than a hundredth of a pixel.
    The corners beside it then tell how the edges bend, so that all of them can be used; a corner that has no
    neighbours on both sides near by keeps its first fit. The slope of the light, the one other parameter that
    is odd about the corner and so moves it, is that of the white level from corner to corner.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    fits : dict of (col, row) to SettledCorner
        The first fits.
    surroundings : dict of (col, row) to Surroundings
        With which they were made.
    settings : CornerSettings

    Returns
    -------
    dict of (col, row) to SettledCorner
        Without those whose wider fit does not converge, or where the light is not known.
    """
    nodes = list(fits)
    grid, places = NodeGrid.of(nodes), np.array([fit.centre for fit in fits.values()])
    states = np.array([fit.state for fit in fits.values()])
    bends = across_edges(edge_bends(grid.spread(places))[grid.at], states)
    steps = _steps(grid.spread(places), grid.spread(np.array([surroundings[node].axes for node in nodes])))
    steps = steps[grid.at]
    wide: dict[Node, SettledCorner] = {}
    clear = set[Node]()
    for k, (node, fit) in enumerate(fits.items()):
        if np.isnan(bends[k]).any():
            clear.add(node)
            continue
        near = replace(
            surroundings[node],
            centre=places[k],
            axes=steps[k],
            reach=settings.max_reach_px,
            share=settings.wide_reach_squares,
            bend=bends[k],
        )
        found = widen(grey, near, fit.state, settings)
        if found is not None:
            wide[node] = found
    wide = _clear(wide, settings)
    final = {node: fits[node] for node in fits if node in clear}
    if not wide:
        return final
    grid, places = NodeGrid.of(list(wide)), np.array([one.centre for one in wide.values()])
    states = np.array([one.state for one in wide.values()])
    bends = across_edges(edge_bends(grid.spread(places))[grid.at], states)
    white = np.array([max(one.state[6] + one.state[7], _DARKEST) for one in wide.values()])
    slopes = light_slopes(grid, places, white, (_LIGHT_NODES, _FEWEST))
    return final | known_light_fits(fits, wide, (slopes, bends), settings)


def _clear(wide: dict[Node, SettledCorner], settings: CornerSettings) -> dict[Node, SettledCorner]:
    """Return the fits that are not much rougher than those around: nothing lies in the squares of these.

    Edges without any blur leave residuals that depend on where they run between pixels.
    """
    if not wide:
        return wide
    grid, roughness = NodeGrid.of(list(wide)), np.array([one.roughness for one in wide.values()])
    usual = median_around(grid.spread(roughness), _ROUGH_NODES)[grid.at]
    sharp = np.array([one.state[4:6].min() <= settings.min_blur_px for one in wide.values()])
    most = settings.clear_roughness_factor * usual + np.where(sharp, settings.roughness_share, 0.0)
    return {node: wide[node] for node, ok in zip(wide, roughness <= most, strict=True) if ok}


def _steps(places: np.ndarray, usual: np.ndarray) -> np.ndarray:
    """Return one square along x and along y at corners, in columns, px, by the corners beside each.

    `usual` (a, b, 2, 2) is where there is no corner beside.
    """
    steps = usual.copy()
    for axis in (0, 1):
        after, before = ahead(places, axis), behind(places, axis)
        both = 0.5 * (after + before)
        for step in (before, after, both):
            steps[..., axis] = np.where(np.isnan(step), steps[..., axis], step)
    return steps
