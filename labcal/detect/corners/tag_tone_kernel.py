"""Steps of the fits of many corners beside a tone curve, in compiled code."""

from math import hypot, sqrt

import numpy as np

from labcal.detect.cholesky import factorise, solve
from labcal.detect.compiled import compiled
from labcal.detect.corners.corner_kernel import PARAMETERS, FitLimits, fill_jacobian
from labcal.detect.corners.tone_curve import by_tone, tone_terms, untoned
from labcal.detect.row_products import add_own_products, filled_up

_TONE, _RESIDUAL, _ROWS = PARAMETERS, PARAMETERS + 1, PARAMETERS + 2
"""Rows of the derivative by the curve, and of the residuals, below those of the parameters; and all."""
_RIDGE, _SINGULAR = 1e-9, 1e-12
_FIRST_BLUR, _LAST_BLUR = 4, 5

Stack = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, int]
"""First pixel of every corner and the end (n + 1,), offsets (2, pixels), values (pixels,), gaps (n, 2), bends
(n, 2) and the pattern of :class:`~labcal.detect.corners.corner_model.CornerPixels`, one corner after the
other."""


@compiled
def curve_equations(
    states: np.ndarray, stack: Stack, free: np.ndarray, tones: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the curve of every corner beside its other parameters, and what the fit's next step takes.

    Parameters
    ----------
    states : ndarray, shape (n, PARAMETERS)
    stack : tuple
    free : ndarray of int, shape (n,)
        Parameters that are fitted, from the first one on.
    tones : ndarray, shape (n,)
        The curves as they are known so far.

    Returns
    -------
    curves : ndarray, shape (n,)
        By how much each differs from that, by least squares.
    products : ndarray, shape (n, PARAMETERS + 2, PARAMETERS + 2)
        Lower triangles of the products of the derivatives by the parameters, that by the curve, and the
        residuals with one another.
    """
    start, offset, value, gap, bend, pattern = stack
    n = len(states)
    curves, products = np.zeros(n), np.zeros((n, _ROWS, _ROWS))
    for c in range(n):
        a, b = start[c], start[c + 1]
        pixels = (np.ascontiguousarray(offset[:, a:b]), value[a:b], gap[c], bend[c], pattern, tones[c])
        table = np.zeros((_ROWS, filled_up(b - a)))
        board = np.empty(b - a)
        fill_jacobian(states[c], pixels, (table[_RESIDUAL], table[:PARAMETERS], board, np.empty(b - a)))
        terms = tone_terms(tones[c])
        for k in range(b - a):
            board[k] = untoned(board[k], terms)
        slope = by_tone(board, tones[c])
        for k in range(b - a):
            light = 1.0 + states[c, 8] * pixels[0][0, k] + states[c, 9] * pixels[0][1, k]
            table[_TONE, k] = light * states[c, 7] * slope[k]
        add_own_products(table, table.shape[1], products[c])
        curves[c] = _curve(products[c], free[c])
    return curves, products


@compiled
def _curve(products: np.ndarray, free: int) -> float:
    """Return the curve by least squares with the `free` first parameters, all scaled to equal lengths."""
    size, used = np.empty(free + 1), np.arange(free + 1)
    used[free] = _TONE
    scaled, found = np.empty((free + 1, free + 1)), np.empty(free + 1)
    for i in range(free + 1):
        size[i] = max(sqrt(products[used[i], used[i]]), _RIDGE)
        found[i] = products[_RESIDUAL, used[i]] / size[i]
        for j in range(i + 1):
            scaled[i, j] = products[used[i], used[j]] / (size[i] * size[j])
        scaled[i, i] += _RIDGE
    if not factorise(scaled, free + 1, _SINGULAR):
        return 0.0
    solve(scaled, found)
    curve: float = found[free] / size[free]
    return curve


@compiled
def curve_steps(
    states: np.ndarray, products: np.ndarray, free: np.ndarray, curves: np.ndarray, limits: FitLimits
) -> tuple[np.ndarray, np.ndarray]:
    """Take one step of every fit, in place, with its curve; return the steps, px, and the residuals' squares.

    A step is infinite, and is not taken, where it is longer than the limits allow or not determined.

    Parameters
    ----------
    states : ndarray, shape (n, PARAMETERS)
    products : ndarray, shape (n, PARAMETERS + 2, PARAMETERS + 2)
        Of :func:`curve_equations` at the states.
    free : ndarray of int, shape (n,)
    curves : ndarray, shape (n,)
        By how much the curve changes.
    limits : FitLimits
    """
    n = len(states)
    steps, squares = np.full(n, np.inf), np.zeros(n)
    change, gradient = np.zeros(PARAMETERS), np.zeros(PARAMETERS)
    for c in range(n):
        normal, curve, count = products[c, :PARAMETERS, :PARAMETERS].copy(), curves[c], free[c]
        change[:] = 0.0
        for i in range(count):
            normal[i, i] *= 1.0 + _RIDGE
            change[i] = gradient[i] = products[c, _RESIDUAL, i] - curve * products[c, _TONE, i]
        if not factorise(normal, count, _SINGULAR):
            continue
        solve(normal, change[:count])
        turn = max(abs(change[2]), abs(change[3]))
        if not (hypot(change[0], change[1]) <= limits.max_step_px and turn <= limits.max_turn_rad):
            continue
        left = products[c, _RESIDUAL, _RESIDUAL]
        left += curve * (curve * products[c, _TONE, _TONE] - 2.0 * products[c, _RESIDUAL, _TONE])
        for i in range(count):
            moved = states[c, i] + change[i]
            if _FIRST_BLUR <= i <= _LAST_BLUR:  # at most doubled or halved
                moved = max(min(max(moved, 0.5 * states[c, i]), 2.0 * states[c, i]), limits.min_blur_px)
            states[c, i] = moved
            left -= change[i] * gradient[i]
        steps[c] = max(abs(change[0]), abs(change[1]))
        squares[c] = max(left, 0.0)
    return steps, squares
