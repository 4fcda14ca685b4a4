"""The blurred pattern of a corner and its fit, in compiled code; what they mean stands at `corner_model`."""

from math import cos, exp, hypot, sin, sqrt
from typing import NamedTuple

import numpy as np

from labcal.detect.cholesky import factorise, solve
from labcal.detect.compiled import compiled, inlined
from labcal.detect.corners.corner_rows import write_levels, write_rows
from labcal.detect.corners.edge_profile import edge_profile
from labcal.detect.corners.quadrature import quadrature
from labcal.detect.row_products import add_own_products, filled_up

PARAMETERS = 10
"""Corner 2, angles of the edges' normals 2, blurs 2, mean, half step, slope of the light 2."""
_FIRST_BLUR, _LAST_BLUR = 4, 5
LIGHT_KNOWN = 8
"""Free parameters of a fit that takes the slope of the light, the last two, for known."""
CHESSBOARD, WEDGE = 0, 1
"""Patterns: a chessboard of -1 and 1; a black wedge on white."""
_MOST_OBLIQUE = 0.999
"""Cosine of the angle between the edges."""
_NOTHING = 16.0
"""exp(-16) of the board's step is nothing."""
_STRAIGHT = 6.0
"""So many blurs from an edge nothing is left of its profile."""
_FAR = 9.0
"""The darkness of an edge so many blurs away is nothing."""
ROWS = 12
"""Of the table of derivatives and, below them, residuals: filled up to whole tiles of products."""
_RIDGE = 1e-9
_SINGULAR = 1e-12


class FitLimits(NamedTuple):
    """The settings of corners that the fit takes."""

    max_iterations: int
    max_step_px: float
    max_turn_rad: float
    min_blur_px: float


Pixels = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, int]
"""Offsets (2, n), values (n,), gap (2,), bend (2,) and the pattern of
:class:`labcal.detect.corners.corner_model.CornerPixels`."""


@inlined
def _board_at(a: float, b: float, correlation: float, rule: np.ndarray) -> tuple[float, float, float, float]:
    """Return a blurred chessboard's value at distances in blurs, and derivatives by a, b and the correlation.

    It is the expectation of ``sign(a + z1) sign(b + z2)`` for standard normal z1, z2. By Plackett's identity
    (1954, Biometrika 41) its derivative by the correlation is four times the density at (a, b), which is
    integrated from correlation 0, where it is a product.
    """
    squares, product = 0.5 * (a * a + b * b), a * b
    if (1.0 - abs(correlation)) * squares > _NOTHING:
        # Beside the corner: a straight edge, and hardly anything of the other one.
        value, slope_a, slope_b = (1.0 if product > 0.0 else -1.0), 0.0, 0.0
        if abs(a) < _STRAIGHT:
            profile, slope = edge_profile(a)
            up = 1.0 if b > 0.0 else -1.0
            value, slope_a = profile * up, slope * up
        if abs(b) < _STRAIGHT:
            profile, slope = edge_profile(b)
            value, slope_b = value * abs(profile), (slope if a > 0.0 else -slope)
        return value, slope_a, slope_b, 0.0
    per_other = 1.0 / sqrt(1.0 - correlation * correlation)
    profile_a, slope_a = edge_profile(a)
    profile_b, slope_b = edge_profile(b)
    value = profile_a * profile_b
    for k in range(rule.shape[1]):
        value += rule[2, k] * exp(-(squares - product * rule[0, k]) * rule[1, k])
    beside_b, density = edge_profile((b - correlation * a) * per_other)
    beside_a, _ = edge_profile((a - correlation * b) * per_other)
    return value, slope_a * beside_b, slope_b * beside_a, slope_a * density * per_other


@inlined
def _darkness(a: float, b: float, gap_a: float, gap_b: float) -> float:
    """Return how much markers, so far away from the edges, darken a chessboard there; distances in blurs."""
    profile_a, _ = edge_profile(abs(a) - gap_a)
    profile_b, _ = edge_profile(abs(b) - gap_b)
    return 0.5 * (1.0 + profile_a) * (1.0 + profile_b)


@inlined
def _wedge_at(
    a: float, b: float, board: tuple[float, float, float, float]
) -> tuple[float, float, float, float]:
    """Return the same as :func:`_board_at` of a wedge, from that of the chessboard with the same edges."""
    profile_a, slope_a = edge_profile(a)
    profile_b, slope_b = edge_profile(b)
    value, by_a, by_b, by_correlation = board
    return (
        0.5 - 0.5 * (value + profile_a + profile_b),
        -0.5 * (by_a + slope_a),
        -0.5 * (by_b + slope_b),
        -0.5 * by_correlation,
    )


@compiled
def pattern_values(u: np.ndarray, correlation: float, gap: np.ndarray, pattern: int) -> np.ndarray:
    """Return a pattern at distances u (2, n) from its edges, with markers `gap` (2,) away; all in blurs."""
    values = np.empty(u.shape[1])
    rule = quadrature(correlation)
    for k in range(u.shape[1]):
        a, b = u[0, k], u[1, k]
        at = _board_at(a, b, correlation, rule)
        if pattern == WEDGE:
            values[k] = _wedge_at(a, b, at)[0]
        else:
            values[k] = at[0] - (_darkness(a, b, gap[0], gap[1]) if a * b > 0.0 else 0.0)
    return values


@compiled
def fill_jacobian(
    state: np.ndarray,
    pixels: Pixels,
    rows: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray],
) -> None:
    """Write residuals, derivatives, the pattern and distances from the edges (in blurs) at a state.

    Parameters
    ----------
    state : ndarray, shape (PARAMETERS,)
    pixels : tuple
    rows : tuple of ndarray
        Residuals (n,), derivatives (PARAMETERS, n), pattern (n,), distances (n,); overwritten.
    """
    offset, value, gap, bend, pattern = pixels
    residual, jacobian, board, off_edges = rows
    correlation = min(max(cos(state[2] - state[3]), -_MOST_OBLIQUE), _MOST_OBLIQUE)
    rule = quadrature(correlation)
    c0, s0, c1, s1 = cos(state[2]), sin(state[2]), cos(state[3]), sin(state[3])
    blur0, blur1 = state[4], state[5]
    # Light falls on the print before the lens blurs it: by Stein's lemma its slope moves each edge.
    moved0, moved1 = blur0 * (c0 * state[8] + s0 * state[9]), blur1 * (c1 * state[8] + s1 * state[9])
    gap0, gap1 = gap[0] / blur0, gap[1] / blur1
    from0, from1 = gap0 - _FAR, gap1 - _FAR
    per0, per1, half0, half1 = 1.0 / blur0, 1.0 / blur1, 0.5 * bend[0], 0.5 * bend[1]
    x, y, x0, y0, n = offset[0], offset[1], state[0], state[1], len(value)
    first, second, turn = np.empty(n), np.empty(n), np.empty(n)
    across0, across1, along0, along1 = jacobian[2], jacobian[3], jacobian[4], jacobian[5]
    for k in range(n):
        dx, dy = x[k] - x0, y[k] - y0
        far0, far1 = c0 * dy - s0 * dx, c1 * dy - s1 * dx
        a = (c0 * dx + s0 * dy - half0 * far0 * far0) * per0 + moved0
        b = (c1 * dx + s1 * dy - half1 * far1 * far1) * per1 + moved1
        at, by_a, by_b, by_correlation = _board_at(a, b, correlation, rule)
        if pattern == WEDGE:
            at, by_a, by_b, by_correlation = _wedge_at(a, b, (at, by_a, by_b, by_correlation))
        elif a * b > 0.0 and abs(a) > from0 and abs(b) > from1:
            at -= _darkness(a, b, gap0, gap1)
        first[k], second[k], turn[k], board[k] = by_a, by_b, by_correlation, at
        across0[k], across1[k], along0[k], along1[k] = far0, far1, a, b
        off_edges[k] = min(abs(a), abs(b))
    write_levels(state, offset, (value, board), (residual, jacobian[6], jacobian[7]))
    write_rows(state, (offset, board), (first, second, turn), jacobian)


@compiled
def settled(
    state: np.ndarray,
    pixels: Pixels,
    ends: tuple[float, int],
    limits: FitLimits,
) -> float:
    """Iterate a state as :func:`settled_with` does, for callers that need no normal matrix."""
    return settled_with(state, pixels, ends, limits, np.empty((ROWS, ROWS)))


@compiled
def settled_with(
    state: np.ndarray,
    pixels: Pixels,
    ends: tuple[float, int],
    limits: FitLimits,
    normal: np.ndarray,
) -> float:
    """Iterate a state, in place, to the least squares (Gauss-Newton); return the residuals' root mean square.

    It is as the last step leaves it by the linear model, and negative if the state runs away.

    `ends` is the step at which it ends, px, and the number of free parameters, from the first one on. To
    `normal` (ROWS, ROWS) the lower triangle of the normal matrix of the last step is written.
    """
    tolerance, free = ends
    n = len(pixels[1])
    table = np.zeros((ROWS, filled_up(n)))
    residual = table[PARAMETERS]
    rows = (residual, table[:PARAMETERS], np.empty(n), np.empty(n))
    change, gradient = np.zeros(PARAMETERS), np.empty(PARAMETERS)
    for _ in range(limits.max_iterations):
        fill_jacobian(state, pixels, rows)
        normal[:] = 0.0
        add_own_products(table, table.shape[1], normal)
        for i in range(free):
            change[i] = gradient[i] = normal[PARAMETERS, i]
            normal[i, i] *= 1.0 + _RIDGE
        factor = normal.copy()
        if not factorise(factor, free, _SINGULAR):
            return -1.0
        solve(factor, change[:free])
        if not np.isfinite(change).all():
            return -1.0
        far = max(hypot(change[0], change[1]) / limits.max_step_px, 1.0)
        far = max(far, max(abs(change[2]), abs(change[3])) / limits.max_turn_rad)
        for i in range(PARAMETERS):
            moved = state[i] + change[i] / far
            if _FIRST_BLUR <= i <= _LAST_BLUR:  # at most doubled or halved
                moved = max(min(max(moved, 0.5 * state[i]), 2.0 * state[i]), limits.min_blur_px)
            state[i] = moved
        if max(abs(change[0]), abs(change[1])) < tolerance:
            squares = normal[PARAMETERS, PARAMETERS]
            for i in range(free):
                squares -= change[i] * gradient[i]
            return sqrt(max(squares, 0.0) / n)
    return -1.0


@compiled
def take_known_light(state: np.ndarray, normal: np.ndarray, slope: np.ndarray) -> None:
    """Set a state at its least squares, in place, to those with another slope of the light.

    By the linear model, whose normal matrix is that of :func:`settled_with`; a fit goes on from there.
    """
    factor = normal.copy()
    if not factorise(factor, LIGHT_KNOWN, _SINGULAR):
        return
    x, y = slope[0] - state[LIGHT_KNOWN], slope[1] - state[LIGHT_KNOWN + 1]
    change = np.empty(LIGHT_KNOWN)
    for i in range(LIGHT_KNOWN):
        change[i] = -normal[LIGHT_KNOWN, i] * x - normal[LIGHT_KNOWN + 1, i] * y
    solve(factor, change)
    for i in range(LIGHT_KNOWN):
        moved = state[i] + change[i]
        if _FIRST_BLUR <= i <= _LAST_BLUR:
            moved = min(max(moved, 0.5 * state[i]), 2.0 * state[i])
        state[i] = moved
