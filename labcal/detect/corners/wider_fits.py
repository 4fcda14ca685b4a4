"""Second fit of the corners of a board: to the middles of the squares, along edges whose bend is known."""

from collections.abc import Callable

import numpy as np

from labcal.detect.corners.board_lens import board_lens
from labcal.detect.corners.corner_fit import SettledCorner, centres_of, widen, widened_with_light
from labcal.detect.corners.corner_rounds import Round
from labcal.detect.corners.corner_window import Places
from labcal.detect.corners.edge_bends import across_edges, edge_bends
from labcal.detect.corners.known_light import light_slopes
from labcal.detect.corners.lens_edges import edge_runs, no_runs, run_bends
from labcal.detect.corners.node_grid import NodeGrid, ahead, behind, median_around
from labcal.detect.corners.roughest import roughest_clear
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
    places: Places,
    usual: Callable[[], np.ndarray],
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
    places : Places
        With which they were made, in their order.
    usual : callable
        Returns one square along x and along y at each of them, in columns, px, shape (n, 2, 2), where there
        is no corner beside.
    settings : CornerSettings

    Returns
    -------
    dict of (col, row) to SettledCorner
        Without those whose wider fit does not converge, or where the light is not known.
    """
    nodes = list(fits)
    grid, centres = NodeGrid.of(nodes), centres_of(list(fits.values()))
    states = np.array([fit.state for fit in fits.values()])
    spread = grid.spread(centres)
    size = grey.shape[1], grey.shape[0]
    lens = board_lens(grid.nodes, centres, size)
    by_lens = None if lens is None else lens.in_picture(grid.nodes, centres)
    bends = across_edges(
        edge_bends(spread, None if by_lens is None else grid.spread(by_lens))[grid.at], states
    )
    steps = _steps(spread)[grid.at]
    if np.isnan(steps).any():
        steps = np.where(np.isnan(steps), usual(), steps)
    determined = np.isfinite(bends).all(axis=1)
    limits = places.limits[determined]
    limits[:, 3:5] = settings.max_reach_px, settings.wide_reach_squares
    near = Places(centres[determined], steps[determined], bends[determined], limits)
    final = {node: fits[node] for node, is_known in zip(nodes, determined, strict=True) if not is_known}
    if not determined.any():
        return final
    runs, reach = no_runs(len(near.centre)), (settings.wide_reach_squares, settings.max_reach_px)
    if lens is not None:
        runs = edge_runs(lens, grid.nodes[determined], near.centre, reach)
    wide = widen(grey, near, (states[determined], runs), settings)
    kept = _clear(wide, grid.nodes[determined], settings.clear_roughness_factor)
    if len(kept) == 0:
        return final
    inner, some = NodeGrid(grid.nodes[determined][kept]), np.array(nodes)[determined][kept].tolist()
    states, centres = wide.states[kept], centres[determined][kept] + wide.states[kept, :2]
    curved = edge_bends(inner.spread(centres))[inner.at]
    final_lens = board_lens(inner.nodes, centres, size) or lens
    if final_lens is not None:
        by_lens = final_lens.in_picture(inner.nodes, centres)
        curved = edge_bends(inner.spread(centres), inner.spread(by_lens))[inner.at]
        curved += run_bends(edge_runs(final_lens, inner.nodes, by_lens, reach)) - run_bends(runs[kept])
    bends = across_edges(curved, states)
    white = np.maximum(states[:, 6] + states[:, 7], _DARKEST)
    slopes = light_slopes(inner, centres, white, (_LIGHT_NODES, _FEWEST))
    known = np.isfinite(bends).all(axis=1) & np.isfinite(slopes).all(axis=1)
    which = kept[known]
    there = Places(near.centre[which], near.axes[which], bends[known], near.limits[which])
    found = iter(widened_with_light(wide, which, there, slopes[known], settings))
    for node, is_known in zip(map(tuple, some), known.tolist(), strict=True):
        fit = next(found) if is_known else fits[node]
        if fit is not None:
            final[node] = fit
    return final


def _clear(wide: Round, nodes: np.ndarray, factor: float) -> np.ndarray:
    """Return the numbers of the fits that are not much rougher than those around.

    Nothing lies in the squares of these.
    """
    kept = np.flatnonzero(wide.ok)
    if len(kept) == 0:
        return kept
    grid, roughness = NodeGrid(nodes[kept]), wide.rms[kept] / (2.0 * wide.states[kept, 7])
    usual = median_around(grid.spread(roughness), _ROUGH_NODES)[grid.at]
    return np.asarray(kept[roughness <= roughest_clear(usual, factor)])


def _steps(places: np.ndarray) -> np.ndarray:
    """Return one square along x and along y at corners, in columns, px, by the corners beside each.

    NaN where there is no corner beside.
    """
    steps = np.full((*places.shape, 2), np.nan)
    for axis in (0, 1):
        after, before = ahead(places, axis), behind(places, axis)
        both = 0.5 * (after + before)
        for step in (before, after, both):
            steps[..., axis] = np.where(np.isnan(step), steps[..., axis], step)
    return steps
