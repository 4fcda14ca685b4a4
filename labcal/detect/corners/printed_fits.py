"""Second fit of the corners of a ChArUco board: by all of the print between them."""

import numpy as np

from labcal.detect.corners.board_print import board_print
from labcal.detect.corners.corner_fit import SettledCorner
from labcal.detect.corners.corners import Corners
from labcal.detect.corners.known_light import light_slopes
from labcal.detect.corners.local_maps import local_maps
from labcal.detect.corners.node_grid import NodeGrid
from labcal.detect.corners.printed_fit import fit_print
from labcal.detect.corners.printed_kernel import LocalMap
from labcal.detect.grey import GreyPicture
from labcal.detect.lattice.lattice import Node
from labcal.detect.stage_settings.corner import CornerSettings
from labcal.targets.charuco import CharucoBoard

_LIGHT_NODES, _FEWEST = (1, 2, 4), 5
"""Nodes to either side whose white levels tell the slope of the light, and the fewest that do."""
_ROUNDS = 2
"""Fits; the map around a corner is that of the round before."""


def printed_corners(
    grey: GreyPicture, board: CharucoBoard, corners: Corners, settings: CornerSettings
) -> Corners:
    """Return corners with their fits by all of the print around each.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    board : CharucoBoard
    corners : Corners
        As of :func:`labcal.detect.corners.corners.measured_corners`.
    settings : CornerSettings
    """
    nodes = [(int(i), int(j)) for i, j in corners.index]
    fits = {node: fit for node, fit in zip(nodes, corners.fits, strict=True) if fit is not None}
    for _ in range(_ROUNDS):
        if not fits:
            break
        fits = _once(grey, board, fits, settings)
    found = [fits.get(node) for node in nodes]
    seen_at = [
        place if fit is None else fit.centre for place, fit in zip(corners.seen_at, found, strict=True)
    ]
    return Corners(corners.index, np.array(seen_at), found)


def _once(
    grey: GreyPicture, board: CharucoBoard, fits: dict[Node, SettledCorner], settings: CornerSettings
) -> dict[Node, SettledCorner]:
    """Return fits by the print, with the maps and the light that given fits tell."""
    nodes, print_ = list(fits), board_print(board)
    places = np.array([fit.centre for fit in fits.values()])
    grid, maps = NodeGrid.of(nodes), local_maps(nodes, places)
    white = np.array([fit.state[6] + fit.state[7] for fit in fits.values()])
    slopes = light_slopes(grid, places, np.where(white > 0.0, white, np.nan), (_LIGHT_NODES, _FEWEST))
    known = maps.known & np.isfinite(slopes[:, 0])
    found = dict(fits)
    for k, (node, fit) in enumerate(fits.items()):
        if not known[k]:
            continue
        around = LocalMap(np.array(node, dtype=np.float64), maps.linear[k], maps.square[k])
        printed = fit_print(grey, fit, (around, print_), slopes[k], settings)
        if printed is not None:
            found[node] = printed
    return found
