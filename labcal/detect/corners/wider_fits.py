"""Second fit of the corners of a board: to the middles of the squares, along edges whose bend is known."""

from dataclasses import replace

import numpy as np

from labcal.detect.corners.corner_fit import CornerFit, Surroundings, WideFit, widen, with_known_light
from labcal.detect.corners.edge_bends import edge_bends
from labcal.detect.grey import GreyPicture
from labcal.detect.lattice.lattice import Node
from labcal.detect.stage_settings.corner import CornerSettings

_LIGHT_NODES = 1
"""Nodes to either side whose white levels tell the slope of the light."""
_FEWEST = 5
_ROUGH_NODES = 2
"""Nodes to either side whose residuals are the usual ones."""


def wider_fits(
    grey: GreyPicture,
    fits: dict[Node, CornerFit],
    around: dict[Node, Surroundings],
    settings: CornerSettings,
) -> dict[Node, CornerFit]:
    """Return the fits of corners over all of their edges that no other corner shares.

    A first fit keeps so near to its corner that no lens bends an edge by more than a hundredth of a pixel.
    The corners beside it then tell how the edges bend, so that all of them can be used; a corner that has no
    neighbours on both sides near by keeps its first fit. The slope of the light, the one other parameter that
    is odd about the corner and so moves it, is that of the white level from corner to corner.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    fits : dict of (col, row) to CornerFit
        The first fits.
    around : dict of (col, row) to Surroundings
        With which they were made.
    settings : CornerSettings

    Returns
    -------
    dict of (col, row) to CornerFit
        Without those whose wider fit does not converge, or where the light is not known.
    """
    places = {node: fit.centre for node, fit in fits.items()}
    bends = edge_bends(places)
    wide: dict[Node, WideFit] = {}
    for node, fit in fits.items():
        if node in bends:
            near = replace(
                around[node],
                centre=fit.centre,
                axes=_steps(places, node, around[node].axes),
                reach=settings.max_reach_px,
                share=settings.wide_reach_squares,
                bend=_across(bends[node], fit.state),
            )
            found = widen(grey, near, fit.state, settings)
            if found is not None:
                wide[node] = found
    wide = _clear(wide, settings.clear_roughness_factor)
    clear = {node for node in fits if node in wide or node not in bends}
    bends, slopes = edge_bends({node: one.centre for node, one in wide.items()}), _slopes(wide)
    final = {node: fits[node] for node in clear if node not in bends or node not in slopes}
    for node, one in wide.items():
        if node not in final:
            known = with_known_light(one, slopes[node], _across(bends[node], one.state), settings)
            if known is not None:
                final[node] = known
    return final


def _across(bends: np.ndarray, state: np.ndarray) -> np.ndarray:
    """Return how much the edges of a fit bend towards their normals, of vectors along x and along y, 1/px."""
    # The first normal is that of the edge along y, the second one that of the edge along x.
    normals = np.stack([np.cos(state[2:4]), np.sin(state[2:4])], axis=-1)
    return np.asarray((normals * bends[::-1]).sum(axis=1))


def _clear(wide: dict[Node, WideFit], factor: float) -> dict[Node, WideFit]:
    """Return the fits that are not much rougher than those around: nothing lies in the squares of these."""
    roughness = {node: one.roughness for node, one in wide.items()}
    around = range(-_ROUGH_NODES, _ROUGH_NODES + 1)
    found = {}
    for (col, row), own in roughness.items():
        near = [
            roughness[col + i, row + j] for i in around for j in around if (col + i, row + j) in roughness
        ]
        if own <= factor * float(np.median(near)):
            found[col, row] = wide[col, row]
    return found


def _slopes(fits: dict[Node, WideFit]) -> dict[Node, np.ndarray]:
    """Return the slope of the light at corners, 1/px: that of the white level of the fits around each.

    Left out where these are too few, or on one line.
    """
    around = range(-_LIGHT_NODES, _LIGHT_NODES + 1)
    found = {}
    for (col, row), own in fits.items():
        near = [fits[col + i, row + j] for i in around for j in around if (col + i, row + j) in fits]
        place = np.array([fit.centre for fit in near]) - own.centre
        white = np.array([fit.state[6] + fit.state[7] for fit in near])
        design = np.concatenate([np.ones((len(near), 1)), place], axis=1)
        if len(near) < _FEWEST or np.linalg.matrix_rank(design) < design.shape[1]:
            continue
        level, *slope = np.linalg.lstsq(design, white, rcond=None)[0]
        found[col, row] = np.array(slope) / level
    return found


def _steps(places: dict[Node, np.ndarray], node: Node, usual: np.ndarray) -> np.ndarray:
    """Return one square along x and along y at a corner, in columns, px, by the corners beside it."""
    steps = usual.copy()
    for axis, (i, j) in enumerate(((1, 0), (0, 1))):
        after, before = (places.get((node[0] + s * i, node[1] + s * j)) for s in (1, -1))
        here = places[node]
        if after is not None and before is not None:
            steps[:, axis] = 0.5 * (after - before)
        elif after is not None:
            steps[:, axis] = after - here
        elif before is not None:
            steps[:, axis] = here - before
    return steps
