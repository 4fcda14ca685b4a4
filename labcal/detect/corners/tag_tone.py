"""Corners of tags without the shift of edges by a tone curve or by ink that has spread."""

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from labcal.detect.corners.corner_fit import SettledCorner, settle
from labcal.detect.corners.corner_model import linearise
from labcal.detect.corners.node_grid import NodeGrid, median_around
from labcal.detect.lattice.lattice import Node
from labcal.detect.stage_settings.corner import CornerSettings

_ROUNDS = 2
"""Fits with the curve of the round before: what is left of a curve after them is below its noise."""
_NEAR = 2
"""Nodes to either side whose curves have one median, against the corners' noise."""
_SIGMAS = 3.0
"""Deviations at which the curve of all corners of a picture is not chance."""
_DEVIATIONS_A_MAD, _MEDIAN_SHARE = 1.4826, 1.2533
"""Standard deviation over the median absolute deviation, and that of a median over that of a mean: normal."""
_RIDGE = 1e-9


def tone_free_fits(fits: Mapping[Node, SettledCorner], settings: CornerSettings) -> dict[Node, SettledCorner]:
    """Return fits with the curve of the tone around each, which is no part of their model, taken out.

    Where grey values are a curved function of light, or ink has spread, all edges seem to move into the black
    or out of it. At a chessboard's corner this is the same on opposite sides, and does not move it. A tag's
    edges are longer than those of the small square at its corner: lines through both then miss the corner.
    To the second order a tone curve adds ``c h (1 - X^2)`` to the picture with half step h and pattern X; so
    does, to the first order, a shift of all edges. c is the median of the least squares of the corners
    around; none is taken out where it is not distinct from 0 over all corners.

    Parameters
    ----------
    fits : mapping of (col, row) to SettledCorner
    settings : CornerSettings

    Returns
    -------
    dict of (col, row) to SettledCorner
        Without those that do not converge.
    """
    found, total = dict(fits), dict.fromkeys(fits, 0.0)
    for number in range(_ROUNDS):
        bumps, curves = _bumps_and_curves(found.values())
        if number == 0 and not _is_distinct(curves):
            break
        grid = NodeGrid.of(list(found))
        near = median_around(grid.spread(curves), _NEAR)[grid.at]
        refitted = {}
        for (node, fit), bump, curve in zip(found.items(), bumps, near.tolist(), strict=True):
            total[node] += curve
            plain = fits[node].window.value - total[node] * bump
            state, window = fit.state.copy(), replace(fit.window, value=plain)
            rms = settle(state, window, settings.tolerance_px, settings, fit.free)
            if rms >= 0.0 and state[7] > 0.0:
                refitted[node] = replace(
                    fit, state=state, window=window, roughness=rms / (2.0 * float(state[7]))
                )
        found = refitted
        if not found:
            break
    return found


def _is_distinct(curves: np.ndarray) -> bool:
    """Return whether the median of curves (n,) is not 0 by chance."""
    if not len(curves):
        return False
    middle = float(np.median(curves))
    spread = _DEVIATIONS_A_MAD * float(np.median(np.abs(curves - middle)))
    return bool(abs(middle) * np.sqrt(len(curves)) > _SIGMAS * _MEDIAN_SHARE * spread)


def _bumps_and_curves(fits: Iterable[SettledCorner]) -> tuple[list[np.ndarray], np.ndarray]:
    """Return ``h (1 - X^2)`` at the pixels of each fit, grey values, and by how much its c differs from 0.

    The latter (n,) by least squares with the fit's free parameters.
    """
    bumps, curves = [], []
    for fit in fits:
        linear = linearise(fit.state, fit.window)
        light = 1.0 + fit.state[8:] @ fit.window.offset
        bump = np.asarray(light * fit.state[7] * (1.0 - linear.board**2))
        rows = np.concatenate([linear.jacobian[: fit.free], bump[None]])
        size = np.maximum(np.linalg.norm(rows, axis=1), _RIDGE)
        rows = rows / size[:, None]
        normal = rows @ rows.T + _RIDGE * np.eye(len(rows))
        bumps.append(bump)
        curves.append(float(np.linalg.solve(normal, rows @ linear.residual)[-1] / size[-1]))
    return bumps, np.array(curves)
