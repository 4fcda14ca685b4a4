"""The blurred pattern of a corner and its fit, in compiled code; what they mean stands at `corner_model`."""

from math import asin, cos, exp, hypot, pi, sin, sqrt
from typing import NamedTuple

import numpy as np

from labcal.detect.cholesky import factorise, solve
from labcal.detect.compiled import compiled
from labcal.detect.corners.edge_profile import edge_profile
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
_NODES_3, _WEIGHTS_3 = (np.ascontiguousarray(part) for part in np.polynomial.legendre.leggauss(3))
_NODES_4, _WEIGHTS_4 = (np.ascontiguousarray(part) for part in np.polynomial.legendre.leggauss(4))
_NODES_6, _WEIGHTS_6 = (np.ascontiguousarray(part) for part in np.polynomial.legendre.leggauss(6))
_NODES_12, _WEIGHTS_12 = (np.ascontiguousarray(part) for part in np.polynomial.legendre.leggauss(12))
_NODES_20, _WEIGHTS_20 = (np.ascontiguousarray(part) for part in np.polynomial.legendre.leggauss(20))
_LEAST, _FEWER, _FEW, _MORE = 0.2, 0.4, 0.75, 0.95
"""Correlations up to which 3 and 4 nodes leave errors below 1e-9, 6 and 12 below 1e-8."""
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


@compiled
def _quadrature(correlation: float) -> np.ndarray:
    """Return sine, squared inverse cosine and weight of the nodes from correlation 0 on, shape (3, k).

    By Gauss and Legendre, as in Drezner and Wesolowsky 1990 for the normal distribution.
    """
    nodes, weights = _NODES_20, _WEIGHTS_20
    if abs(correlation) < _LEAST:
        nodes, weights = _NODES_3, _WEIGHTS_3
    elif abs(correlation) < _FEWER:
        nodes, weights = _NODES_4, _WEIGHTS_4
    elif abs(correlation) < _FEW:
        nodes, weights = _NODES_6, _WEIGHTS_6
    elif abs(correlation) < _MORE:
        nodes, weights = _NODES_12, _WEIGHTS_12
    half = 0.5 * asin(correlation)
    rule = np.empty((3, len(nodes)))
    for k in range(len(nodes)):
        turn = half * (1.0 + nodes[k])
        rule[0, k], rule[1, k] = sin(turn), 1.0 / cos(turn) ** 2
        rule[2, k] = 2.0 / pi * half * weights[k]
    return rule


@compiled
def _board_at(a: float, b: float, correlation: float, rule: np.ndarray) -> tuple[float, float, float, float]:
    """Return a blurred chessboard's value, and derivatives by a, b and the correlation, at distances in blurs.

    It is the expectation of ``sign(a + z1) sign(b + z2)`` for standard normal z1, z2. By Plackett's identity
    (1954, Biometrika 41) its derivative by the correlation is four times the density at (a, b), which is
    integrated from correlation 0, where it is a product.
    """
    squares, product = 0.5 * (a * a + b * b), a * b
    if (1.0 - abs(correlation)) * squares > _NOTHING:
        # Beside the corner: a straight edge, and hardly anything of the other one.
        up_a, up_b = (1.0 if a > 0.0 else -1.0), (1.0 if b > 0.0 else -1.0)
        value, slope_a, slope_b = up_a * up_b, 0.0, 0.0
        if abs(a) < _STRAIGHT:
            profile, slope = edge_profile(a)
            value, slope_a = profile * up_b, slope * up_b
        if abs(b) < _STRAIGHT:
            profile, slope = edge_profile(b)
            value, slope_b = value * profile * up_b, slope * up_a
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


@compiled
def _with_markers(a: float, b: float, gap_a: float, gap_b: float) -> float:
    """Return how much markers, so far away from the edges, darken a chessboard there; distances in blurs."""
    if a * b > 0.0 and abs(a) > gap_a - _FAR and abs(b) > gap_b - _FAR:
        return 0.5 * (1.0 + edge_profile(abs(a) - gap_a)[0]) * (1.0 + edge_profile(abs(b) - gap_b)[0])
    return 0.0


@compiled
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
    rule = _quadrature(correlation)
    for k in range(u.shape[1]):
        a, b = u[0, k], u[1, k]
        at = _board_at(a, b, correlation, rule)
        if pattern == WEDGE:
            values[k] = _wedge_at(a, b, at)[0]
        else:
            values[k] = at[0] - _with_markers(a, b, gap[0], gap[1])
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
    rule = _quadrature(correlation)
    turn_size = sin(state[2] - state[3])
    c0, s0, c1, s1 = cos(state[2]), sin(state[2]), cos(state[3]), sin(state[3])
    blur0, blur1 = state[4], state[5]
    mean, step = state[6], state[7]
    # Light falls on the print before the lens blurs it: by Stein's lemma its slope moves each edge.
    moved0, moved1 = blur0 * (c0 * state[8] + s0 * state[9]), blur1 * (c1 * state[8] + s1 * state[9])
    turned0 = blur0**2 * (c0 * state[9] - s0 * state[8])
    turned1 = blur1**2 * (c1 * state[9] - s1 * state[8])
    gap0, gap1 = gap[0] / blur0, gap[1] / blur1
    per0, per1, half0, half1 = 1.0 / blur0, 1.0 / blur1, 0.5 * bend[0], 0.5 * bend[1]
    slope_x, slope_y, x0, y0 = state[8], state[9], state[0], state[1]
    spread_x0, spread_y0 = c0 * blur0**2, s0 * blur0**2
    spread_x1, spread_y1 = c1 * blur1**2, s1 * blur1**2
    for k in range(len(value)):
        x, y = offset[0, k], offset[1, k]
        dx, dy = x - x0, y - y0
        across0, across1 = c0 * dy - s0 * dx, c1 * dy - s1 * dx
        a = (c0 * dx + s0 * dy - half0 * across0 * across0) * per0 + moved0
        b = (c1 * dx + s1 * dy - half1 * across1 * across1) * per1 + moved1
        at, by_a, by_b, by_correlation = _board_at(a, b, correlation, rule)
        if pattern == WEDGE:
            at, by_a, by_b, by_correlation = _wedge_at(a, b, (at, by_a, by_b, by_correlation))
        else:
            at -= _with_markers(a, b, gap0, gap1)
        light = 1.0 + slope_x * x + slope_y * y
        plain, lit = mean + step * at, light * step
        first, second, turn = lit * per0 * by_a, lit * per1 * by_b, lit * by_correlation * turn_size
        jacobian[0, k] = -first * c0 - second * c1
        jacobian[1, k] = -first * s0 - second * s1
        jacobian[2, k] = first * (across0 + turned0) - turn
        jacobian[3, k] = second * (across1 + turned1) + turn
        jacobian[4, k] = first * (2.0 * moved0 - a)
        jacobian[5, k] = second * (2.0 * moved1 - b)
        jacobian[6, k] = light
        jacobian[7, k] = light * at
        jacobian[8, k] = x * plain + first * spread_x0 + second * spread_x1
        jacobian[9, k] = y * plain + first * spread_y0 + second * spread_y1
        residual[k] = value[k] - light * plain
        board[k] = at
        off_edges[k] = min(abs(a), abs(b))


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
