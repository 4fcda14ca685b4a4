"""Second fit of the corners of a board: to the middles of the squares, along edges whose bend is known."""

from dataclasses import replace

import numpy as np

from labcal.detect.corners.corner_fit import CornerFit, Surroundings, refit_corner
from labcal.detect.corners.edge_bends import edge_bends
from labcal.detect.grey import GreyPicture
from labcal.detect.lattice.lattice import Node
from labcal.detect.stage_settings.corner import CornerSettings


def wider_fits(
    grey: GreyPicture,
    fits: dict[Node, CornerFit],
    around: dict[Node, Surroundings],
    settings: CornerSettings,
) -> dict[Node, CornerFit]:
    """Return the fits of corners over all of their edges that no other corner shares.

    A first fit keeps so near to its corner that no lens bends an edge by more than a hundredth of a pixel.
    The corners beside it then tell how the edges bend, so that all of them can be used; a corner that has no
    neighbours on both sides near by keeps its first fit.

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
        Without corners beside which something is in the way: those whose wider fit does not converge.
    """
    places = {node: fit.centre for node, fit in fits.items()}
    bends = edge_bends(places)
    found = {}
    for node, fit in fits.items():
        if node not in bends:
            found[node] = fit
            continue
        # The first normal is that of the edge along y, the second one that of the edge along x.
        normals = np.stack([np.cos(fit.state[2:4]), np.sin(fit.state[2:4])], axis=-1)
        bend = (normals * bends[node][::-1]).sum(axis=1)
        near = replace(
            around[node],
            centre=fit.centre,
            axes=_steps(places, node, around[node].axes),
            reach=settings.max_reach_px,
            bend=bend,
        )
        wider = refit_corner(grey, near, fit, settings)
        if wider is not None:
            found[node] = wider
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
