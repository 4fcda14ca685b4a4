"""Second fit of the corners of a ChArUco board: by all of the print between them."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from labcal.detect.corners.board_print import board_print
from labcal.detect.corners.corner_agreement import agreeing
from labcal.detect.corners.corner_fit import SettledCorner, judge_all
from labcal.detect.corners.corners import Corners, spans_a_plane
from labcal.detect.corners.known_light import light_slopes
from labcal.detect.corners.local_maps import local_maps
from labcal.detect.corners.node_grid import NodeGrid, median_around
from labcal.detect.corners.print_errors import PrintErrors, print_errors, with_print_errors
from labcal.detect.corners.printed_fit import PrintedCorner, fit_print
from labcal.detect.corners.printed_kernel import PrintLines
from labcal.detect.corners.printed_place import LocalMap
from labcal.detect.corners.roughest import LEAST_ROUGHNESS, roughest_clear
from labcal.detect.grey import GreyPicture
from labcal.detect.lattice.lattice import Node
from labcal.detect.stage_settings.corner import CornerSettings
from labcal.targets.charuco import CharucoBoard

_LIGHT_NODES, _FEWEST = (1, 2, 4), 5
"""Nodes to either side whose white levels tell the slope of the light, and the fewest that do."""
_ROUGH_NODES = 2
"""Nodes to either side whose residuals are the usual ones."""
_ROUGHEST, _ROUGHEST_SHARE = 1.6, 0.002
"""Residuals, in usual ones and besides in the step, above which a corner tells nothing of those around it."""
_ROUNDS, _MOST_ROUNDS = 2, 5
"""Fits, at least, and with departures of the print that change; the map around a corner is that of the round
before."""


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
    first = {node: fit for node, fit in zip(nodes, corners.fits, strict=True) if fit is not None}
    if not spans_a_plane(np.array(list(first), dtype=np.int64).reshape(-1, 2)):
        return corners
    fits, design = first, board_print(board)
    of_squares = _errors(first, settings)
    errors = PrintErrors.none(design)
    for number in range(1, _MOST_ROUNDS + 1):
        print_ = errors.of(design).lines, errors.tone
        printed = _by_print(grey, print_, (fits, of_squares), settings)
        fits = first | printed
        if number == _MOST_ROUNDS:
            break
        departures = print_errors(design, errors, [fit for fit in printed.values() if fit.whole])
        if number >= _ROUNDS and departures.are_near(errors):
            break
        errors = departures
    fits |= {node: with_print_errors(design, errors, fit) for node, fit in printed.items()}
    fits = _as_printed(first, fits, settings.clear_roughness_factor)
    found = [fits.get(node) for node in nodes]
    seen_at = [
        place if fit is None else fit.centre for place, fit in zip(corners.seen_at, found, strict=True)
    ]
    return Corners(corners.index, np.array(seen_at), found)


def _by_print(
    grey: GreyPicture,
    print_: tuple[PrintLines, float],
    known: tuple[Mapping[Node, SettledCorner], Mapping[Node, float]],
    settings: CornerSettings,
) -> dict[Node, PrintedCorner]:
    """Return the fits by the print that converge, with the maps and the light that given fits tell.

    `known` are these, and errors of the places of those that are by squares alone, px.
    """
    fits, of_squares = known
    nodes = list(fits)
    places = np.array([fit.centre for fit in fits.values()])
    sigma = np.array(
        [fit.sigma if isinstance(fit, PrintedCorner) else of_squares[node] for node, fit in fits.items()]
    )
    roughness = np.array([fit.roughness for fit in fits.values()])
    clear = roughness <= _ROUGHEST * float(np.median(roughness)) + _ROUGHEST_SHARE
    if spans_a_plane(np.array(nodes, dtype=np.int64)[clear]):
        sigma[~clear] = np.inf  # covered in part: such a corner may be off by a pixel
    grid, maps = NodeGrid.of(nodes), local_maps(nodes, places, sigma, (grey.shape[1], grey.shape[0]))
    white = np.array([fit.state[6] + fit.state[7] for fit in fits.values()])
    slopes = light_slopes(grid, places, np.where(white > 0.0, white, np.nan), (_LIGHT_NODES, _FEWEST))
    found, places_on = {}, {}
    for k in np.flatnonzero(maps.known & np.isfinite(slopes[:, 0])).tolist():
        around = LocalMap(
            np.array(nodes[k], dtype=np.float64),
            *(part[k] for part in (maps.linear, maps.square, maps.perspective, maps.cube)),
        )
        first = fits[nodes[k]]
        state = np.concatenate([first.state[:8], slopes[k]])
        begin = replace(first, state=state)
        places_on[nodes[k]] = begin, (around, maps.information[k], maps.beyond[k])
        printed = fit_print(grey, *places_on[nodes[k]], print_, settings)
        if printed is not None:
            found[nodes[k]] = printed
    unhidden = _clear(found, settings.clear_roughness_factor)
    if not unhidden:
        return {}
    usual = float(np.median([fit.roughness for fit in unhidden.values()]))
    for node in [node for node in places_on if node not in unhidden]:
        printed = fit_print(grey, *places_on[node], print_, settings, usual)
        if printed is not None:
            found[node] = printed
    return _clear(found, settings.clear_roughness_factor)


def _errors(fits: Mapping[Node, SettledCorner], settings: CornerSettings) -> dict[Node, float]:
    """Return the errors of fits' places along either axis, px; infinite of those that tell nothing.

    These are the ones whose error is unknown, and those that are not where the others predict them: corners
    fitted to the edge of something in front of the board.
    """
    certain = dict(zip(fits, judge_all(list(fits.values()), settings), strict=True))
    judged = {node: fit for node, fit in certain.items() if fit is not None}
    errors = dict.fromkeys(fits, float("inf"))
    if judged:
        kept = agreeing(
            np.array(list(judged), dtype=np.float64),
            np.stack([fit.centre for fit in judged.values()]),
            np.stack([fit.covariance for fit in judged.values()]),
        )
        for (node, fit), agrees in zip(judged.items(), kept.tolist(), strict=True):
            errors[node] = float(np.sqrt(0.5 * np.trace(fit.covariance))) if agrees else float("inf")
    return errors


def _as_printed(
    first: Mapping[Node, SettledCorner], fits: Mapping[Node, SettledCorner], factor: float
) -> dict[Node, SettledCorner]:
    """Return fits, or first ones, of squares alone, where markers are not as printed: worn, or covered."""
    usual = float(np.median([fit.roughness for fit in first.values()]))
    return {
        node: fit
        if fit.roughness <= factor * max(usual, first[node].roughness, LEAST_ROUGHNESS)
        else first[node]
        for node, fit in fits.items()
    }


def _clear(printed: Mapping[Node, PrintedCorner], factor: float) -> dict[Node, PrintedCorner]:
    """Return the fits that are not much rougher than those around: nothing hides the print of these."""
    if not printed:
        return {}
    grid, roughness = NodeGrid.of(list(printed)), np.array([fit.roughness for fit in printed.values()])
    usual = median_around(grid.spread(roughness), _ROUGH_NODES)[grid.at]
    clear = roughness <= roughest_clear(usual, factor)
    return {node: fit for (node, fit), ok in zip(printed.items(), clear.tolist(), strict=True) if ok}
