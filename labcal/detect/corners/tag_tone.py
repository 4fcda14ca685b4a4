"""Corners of tags fitted with the tone curve, which shifts their edges, or with ink that has spread."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from labcal.detect.corners.corner_fit import SettledCorner, settle
from labcal.detect.corners.corner_kernel import FitLimits
from labcal.detect.corners.corner_model import CornerPixels
from labcal.detect.corners.node_grid import NodeGrid, median_around
from labcal.detect.corners.tag_tone_kernel import Stack, curve_equations, curve_steps
from labcal.detect.corners.tone_curve import MOST_TONE
from labcal.detect.lattice.lattice import Node
from labcal.detect.medians import DEVIATIONS_A_MAD, median_of
from labcal.detect.stage_settings.corner import CornerSettings

_MOST_ROUNDS = 4
"""Steps of the fits, each with the curve that those before leave; they end with the usual tolerance."""
_WORST_STEPS = 4.0
"""Last steps of single corners, in the tolerance, above which they go on by themselves."""
_NEAR = 2
"""Nodes to either side whose curves have one median, against the corners' noise."""
_SIGMAS = 3.0
"""Deviations at which the curve of all corners of a picture is not chance."""
_MEDIAN_SHARE = 1.2533
"""Standard deviation of a median over that of a mean: normal."""


def fits_by_tone(fits: Mapping[Node, SettledCorner], settings: CornerSettings) -> dict[Node, SettledCorner]:
    """Return converged fits of pictures by the tone curve around each.

    Where grey values are a curved function of light, or ink has spread, all edges seem to move into the black
    or out of it. At a chessboard's corner this is the same on opposite sides, and does not move it. A tag's
    edges are longer than those of the small square at its corner: lines through both then miss the corner.
    The curve is that of :mod:`~labcal.detect.corners.tone_curve`, whose first order is also that of a shift
    of all edges. Its c is the median of the least squares of the corners around, and 0 where it is not
    distinct from 0 over all corners.

    Curve and fits converge together: each step of Gauss-Newton has the curve that is known so far.

    Parameters
    ----------
    fits : mapping of (col, row) to SettledCorner
        They need not have converged.
    settings : CornerSettings

    Returns
    -------
    dict of (col, row) to SettledCorner
        Without those that do not converge.
    """
    if not fits:
        return {}
    every = list(fits.values())
    stack = _stacked([fit.window for fit in every])
    states, free = np.array([fit.state for fit in every]), np.array([fit.free for fit in every])
    grid, limits = NodeGrid.of(list(fits)), settings.limits(FitLimits)
    tones = np.zeros(len(every))
    for number in range(_MOST_ROUNDS):
        changes, products = curve_equations(states, stack, free, tones)
        is_curved = number > 0 or _is_distinct(changes)
        if is_curved:
            around = median_around(grid.spread(tones + changes), _NEAR)[grid.at]
            changes = np.clip(around, -MOST_TONE, MOST_TONE) - tones
        else:
            changes = np.zeros(len(every))
        tones += changes
        steps, squares = curve_steps(states, products, free, changes, limits)
        if not is_curved or median_of(steps) <= settings.tolerance_px:
            break
    found, most = {}, _WORST_STEPS * settings.tolerance_px if is_curved else settings.tolerance_px
    for k, (node, fit) in enumerate(fits.items()):
        window = replace(fit.window, tone=float(tones[k]))
        rms = float(np.sqrt(squares[k] / len(window.value)))
        if steps[k] > most:
            rms = settle(states[k], window, settings.tolerance_px, settings, fit.free)
        half = float(states[k, 7])
        if rms >= 0.0 and half > 0.0:
            found[node] = replace(fit, state=states[k], pixels=window, roughness=rms / (2.0 * half))
    return found


def _stacked(windows: list[CornerPixels]) -> Stack:
    """Return the pixels of windows for compiled code."""
    start = np.concatenate([[0], np.cumsum([len(one.value) for one in windows])])
    offset, value = (
        np.concatenate([getattr(one, part) for one in windows], axis=-1) for part in ("offset", "value")
    )
    gap, bend = (np.array([getattr(one, part) for one in windows]) for part in ("gap", "bend"))
    return start, offset, value, gap, bend, windows[0].pattern


def _is_distinct(curves: np.ndarray) -> bool:
    """Return whether the median of curves (n,) is not 0 by chance."""
    middle = float(np.median(curves))
    spread = DEVIATIONS_A_MAD * float(np.median(np.abs(curves - middle)))
    return bool(abs(middle) * np.sqrt(len(curves)) > _SIGMAS * _MEDIAN_SHARE * spread)
