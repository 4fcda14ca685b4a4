"""The blurred pattern of a corner and its fit, in compiled code; what they mean stands at `corner_model`."""

from math import asin, cos, erf, exp, hypot, pi, sin, sqrt
from typing import NamedTuple

import numpy as np

from labcal.detect.cholesky import factorise, solve
from labcal.detect.compiled import compiled

PARAMETERS = 10
"""Corner 2, angles of the edges' normals 2, blurs 2, mean, half step, slope of the light 2."""
_FIRST_BLUR, _LAST_BLUR = 4, 5
LIGHT_KNOWN = 8
"""Free parameters of a fit that takes the slope of the light, the last two, for known."""
CHESSBOARD, WEDGE = 0, 1
"""Patterns: a chessboard of -1 and 1; a black wedge on white."""
_MOST_OBLIQUE = 0.999
"""Cosine of the angle between the edges."""
_NODES_6, _WEIGHTS_6 = (np.ascontiguousarray(part) for part in np.polynomial.legendre.leggauss(6))
_NODES_12, _WEIGHTS_12 = (np.ascontiguousarray(part) for part in np.polynomial.legendre.leggauss(12))
_NODES_20, _WEIGHTS_20 = (np.ascontiguousarray(part) for part in np.polynomial.legendre.leggauss(20))
_FEW, _MORE = 0.75, 0.95
"""Correlations up to which 6 and 12 nodes leave errors below 1e-8."""
_NOTHING = 16.0
"""exp(-16) of the board's step is nothing."""
_STRAIGHT = 6.0
"""So many blurs from an edge nothing is left of its profile."""
_FAR = 9.0
"""The darkness of an edge so many blurs away is nothing."""
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
    if abs(correlation) < _FEW:
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
def _board_at(a: float, b: float, correlation: float, rule: np.ndarray, out: np.ndarray) -> None:
    """Write a blurred chessboard's value, and derivatives by a, b and the correlation, at distances in blurs.

    It is the expectation of ``sign(a + z1) sign(b + z2)`` for standard normal z1, z2. By Plackett's identity
    (1954, Biometrika 41) its derivative by the correlation is four times the density at (a, b), which is
    integrated from correlation 0, where it is a product.
    """
    squares, product = 0.5 * (a * a + b * b), a * b
    if (1.0 - abs(correlation)) * squares > _NOTHING:
        # Beside the corner: a straight edge, and hardly anything of the other one.
        out[:] = 0.0
        up_a, up_b = (1.0 if a > 0.0 else -1.0), (1.0 if b > 0.0 else -1.0)
        out[0] = up_a * up_b
        if abs(a) < _STRAIGHT:
            out[0] *= erf(abs(a) / sqrt(2.0))
            out[1] = sqrt(2.0 / pi) * exp(-0.5 * a * a) * up_b
        if abs(b) < _STRAIGHT:
            out[0] *= erf(abs(b) / sqrt(2.0))
            out[2] = sqrt(2.0 / pi) * exp(-0.5 * b * b) * up_a
        return
    other2 = 1.0 - correlation * correlation
    other = sqrt(other2)
    value = erf(a / sqrt(2.0)) * erf(b / sqrt(2.0))
    for k in range(rule.shape[1]):
        value += rule[2, k] * exp(-(squares - product * rule[0, k]) * rule[1, k])
    out[0] = value
    out[1] = sqrt(2.0 / pi) * exp(-0.5 * a * a) * erf((b - correlation * a) / (other * sqrt(2.0)))
    out[2] = sqrt(2.0 / pi) * exp(-0.5 * b * b) * erf((a - correlation * b) / (other * sqrt(2.0)))
    out[3] = 2.0 / (pi * other) * exp(-(squares - correlation * product) / other2)


@compiled
def _pattern_at(
    u: np.ndarray, blend: tuple[float, np.ndarray], gap: np.ndarray, pattern: int, out: np.ndarray
) -> None:
    """Write the value and derivatives of a pattern at distances u (2,) from its edges, in blurs.

    `blend` holds the correlation and its quadrature.
    """
    a, b = u[0], u[1]
    _board_at(a, b, blend[0], blend[1], out)
    if pattern == WEDGE:
        below_a, below_b = 0.5 * (1.0 + erf(a / sqrt(2.0))), 0.5 * (1.0 + erf(b / sqrt(2.0)))
        root = sqrt(2.0 * pi)
        out[0] = 1.5 - 0.5 * out[0] - below_a - below_b
        out[1] = -0.5 * out[1] - exp(-0.5 * a * a) / root
        out[2] = -0.5 * out[2] - exp(-0.5 * b * b) / root
        out[3] = -0.5 * out[3]
    elif a * b > 0.0 and abs(a) > gap[0] - _FAR and abs(b) > gap[1] - _FAR:
        dark_a = 0.5 * (1.0 + erf((abs(a) - gap[0]) / sqrt(2.0)))
        dark_b = 0.5 * (1.0 + erf((abs(b) - gap[1]) / sqrt(2.0)))
        out[0] -= 2.0 * dark_a * dark_b


@compiled
def pattern_values(u: np.ndarray, correlation: float, gap: np.ndarray, pattern: int) -> np.ndarray:
    """Return a pattern at distances u (2, n) from its edges, with markers `gap` (2,) away; all in blurs."""
    values, at = np.empty(u.shape[1]), np.empty(4)
    blend = (correlation, _quadrature(correlation))
    for k in range(u.shape[1]):
        _pattern_at(u[:, k], blend, gap, pattern, at)
        values[k] = at[0]
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
    blend = (correlation, _quadrature(correlation))
    turn_size = sin(state[2] - state[3])
    c0, s0, c1, s1 = cos(state[2]), sin(state[2]), cos(state[3]), sin(state[3])
    blur0, blur1 = state[4], state[5]
    mean, step = state[6], state[7]
    u, gaps, at = np.empty(2), np.empty(2), np.empty(4)
    gaps[0], gaps[1] = gap[0] / blur0, gap[1] / blur1
    for k in range(len(value)):
        x, y = offset[0, k], offset[1, k]
        dx, dy = x - state[0], y - state[1]
        across0, across1 = c0 * dy - s0 * dx, c1 * dy - s1 * dx
        u[0] = (c0 * dx + s0 * dy - 0.5 * bend[0] * across0 * across0) / blur0
        u[1] = (c1 * dx + s1 * dy - 0.5 * bend[1] * across1 * across1) / blur1
        _pattern_at(u, blend, gaps, pattern, at)
        light = 1.0 + state[8] * x + state[9] * y
        plain = mean + step * at[0]
        first, second = light * step / blur0 * at[1], light * step / blur1 * at[2]
        turn = light * step * at[3] * turn_size
        jacobian[0, k] = -first * c0 - second * c1
        jacobian[1, k] = -first * s0 - second * s1
        jacobian[2, k] = first * across0 - turn
        jacobian[3, k] = second * across1 + turn
        jacobian[4, k] = -first * u[0]
        jacobian[5, k] = -second * u[1]
        jacobian[6, k] = light
        jacobian[7, k] = light * at[0]
        jacobian[8, k] = x * plain
        jacobian[9, k] = y * plain
        residual[k] = value[k] - light * plain
        board[k] = at[0]
        off_edges[k] = min(abs(u[0]), abs(u[1]))


@compiled
def settled(
    state: np.ndarray,
    pixels: Pixels,
    ends: tuple[float, int],
    limits: FitLimits,
) -> float:
    """Iterate a state, in place, to the least squares (Gauss-Newton); return the residuals' root mean square.

    It is as the last step leaves it by the linear model, and negative if the state runs away.

    `ends` is the step at which it ends, px, and the number of free parameters, from the first one on.
    """
    tolerance, free = ends
    n = len(pixels[1])
    rows = (np.empty(n), np.empty((PARAMETERS, n)), np.empty(n), np.empty(n))
    residual, jacobian = rows[0], rows[1]
    change, gradient = np.empty(PARAMETERS), np.empty(PARAMETERS)
    for _ in range(limits.max_iterations):
        fill_jacobian(state, pixels, rows)
        normal = jacobian @ jacobian.T
        change[free:] = 0.0
        for i in range(free):
            change[i] = (jacobian[i] * residual).sum()
            normal[i, i] *= 1.0 + _RIDGE
        gradient[:] = change
        if not factorise(normal, free, _SINGULAR):
            return -1.0
        solve(normal, change[:free])
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
            squares = (residual * residual).sum() - (change * gradient).sum()
            return sqrt(max(squares, 0.0) / n)
    return -1.0
