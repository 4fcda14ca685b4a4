"""The blurred print around a corner and its fit, in compiled code; what they mean stands at `printed_fit`."""

from math import hypot, log, sqrt
from typing import NamedTuple

import numpy as np

from labcal.detect.cholesky import factorise, solve
from labcal.detect.compiled import compiled
from labcal.detect.corners.corner_judgement import JudgementLimits, place_error
from labcal.detect.corners.corner_kernel import FitLimits
from labcal.detect.corners.printed_profile import (
    MOST_OBLIQUE,
    Axis,
    near_lines,
    quadrature,
    seen_lines,
    write_profile,
)
from labcal.detect.row_products import add_own_products, filled_up

FREE = 16
"""Free parameters: corner 2, blurs 2, mean, half step, and the coefficients of both axes' map, 5 each."""
ROWS = FREE + 2
"""Of a table of these and the residuals behind them: whole tiles of products."""
_OWN, _TERMS, _LINEAR = 6, 5, 2
_OF_STATE = np.array([0, 1, 4, 5, 6, 7])
"""Their places among the ten of a chessboard's corner."""
_FIRST_BLUR, _LAST_BLUR = 2, 3
_STEEPEST = sqrt(2.0 / np.pi)
"""Change of a blurred step from -1 to 1 over a blur, at the step."""
_FLAT = 1e-8
_RIDGE = 1e-9
_SINGULAR = 1e-12


class LocalMap(NamedTuple):
    """Map from offsets (px) from a corner to places on the print, in squares.

    ``at + M r / (1 + h r) + (q0 x^2 / 2 + q1 x y + q2 y^2 / 2)`` along each axis, and of third order
    ``c0 x^3 / 6 + c1 x^2 y / 2 + c2 x y^2 / 2 + c3 y^3 / 6``.
    """

    at: np.ndarray
    """(2,), of the corner."""
    linear: np.ndarray
    """(2, 2)."""
    square: np.ndarray
    """(2, 3)."""
    perspective: np.ndarray
    """(2,), h; known."""
    cube: np.ndarray
    """(2, 4); known."""


class PrintLines(NamedTuple):
    """A print of cells between lines."""

    x: np.ndarray
    y: np.ndarray
    """Places of the lines along each axis, squares, ascending."""
    cells: np.ndarray
    """1 for white and -1 for black, shape (len(x) + 1, len(y) + 1)."""


Rows = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
"""Residuals (n,), derivatives (FREE, n), pattern (n,) and distances from edges in blurs (n,)."""


@compiled
def empty_rows(n: int) -> Rows:
    """Return arrays for that many pixels."""
    return np.empty(n), np.empty((FREE, n)), np.empty(n), np.empty(n)


@compiled
def most_correlated(offset: np.ndarray, around: LocalMap) -> float:
    """Return the largest correlation of the blurs along both axes, about, at pixels (2, n) of a window."""
    M, h = around.linear, around.perspective
    x, y = np.abs(offset[0]).max(), np.abs(offset[1]).max()
    most = 0.0
    for across in (-1.0, 0.0, 1.0):
        for down in (-1.0, 0.0, 1.0):
            # Half way to the corners of the rectangle, which is wider than the window.
            along, up = 0.5 * across * x, 0.5 * down * y
            away = 1.0 / max(1.0 + h[0] * along + h[1] * up, 0.1)
            plain = M @ np.array([along, up]) * away
            px, py = M[0, 0] - plain[0] * h[0], M[0, 1] - plain[0] * h[1]
            qx, qy = M[1, 0] - plain[1] * h[0], M[1, 1] - plain[1] * h[1]
            most = max(most, abs(px * qx + py * qy) / (hypot(px, py) * hypot(qx, qy)))
    return most


class SeenPlace(NamedTuple):
    """A pixel's place on the print, with the slopes of the map there."""

    first: Axis
    second: Axis
    slopes: tuple[float, float, float, float]
    """Of both places by x and y, 1/px."""
    moved: tuple[float, float]
    """Of both places by the slope of the light, over the blurs in px."""


@compiled
def seen_place(state: np.ndarray, around: LocalMap, x: float, y: float) -> SeenPlace:
    """Return the place that is seen at an offset from the corner, px."""
    M, Q, h = around.linear, around.square, around.perspective
    gx, gy = state[8], state[9]
    away = 1.0 / (1.0 + h[0] * x + h[1] * y)
    plain_x, plain_y = (M[0, 0] * x + M[0, 1] * y) * away, (M[1, 0] * x + M[1, 1] * y) * away
    px = (M[0, 0] - plain_x * h[0]) * away + Q[0, 0] * x + Q[0, 1] * y
    py = (M[0, 1] - plain_x * h[1]) * away + Q[0, 1] * x + Q[0, 2] * y
    qx = (M[1, 0] - plain_y * h[0]) * away + Q[1, 0] * x + Q[1, 1] * y
    qy = (M[1, 1] - plain_y * h[1]) * away + Q[1, 1] * x + Q[1, 2] * y
    bent_x = 0.5 * Q[0, 0] * x * x + Q[0, 1] * x * y + 0.5 * Q[0, 2] * y * y
    bent_y = 0.5 * Q[1, 0] * x * x + Q[1, 1] * x * y + 0.5 * Q[1, 2] * y * y
    c = around.cube
    by_x, by_xy, by_y = 0.5 * x * x, x * y, 0.5 * y * y
    px += c[0, 0] * by_x + c[0, 1] * by_xy + c[0, 2] * by_y
    py += c[0, 1] * by_x + c[0, 2] * by_xy + c[0, 3] * by_y
    qx += c[1, 0] * by_x + c[1, 1] * by_xy + c[1, 2] * by_y
    qy += c[1, 1] * by_x + c[1, 2] * by_xy + c[1, 3] * by_y
    bent_x += ((c[0, 0] * x + 3.0 * c[0, 1] * y) * by_x + (3.0 * c[0, 2] * x + c[0, 3] * y) * by_y) / 3.0
    bent_y += ((c[1, 0] * x + 3.0 * c[1, 1] * y) * by_x + (3.0 * c[1, 2] * x + c[1, 3] * y) * by_y) / 3.0
    # Light falls on the print before the lens blurs it: by Stein's lemma its slope moves all edges.
    moved0, moved1 = state[4] * (px * gx + py * gy), state[5] * (qx * gx + qy * gy)
    first2, second2 = px * px + py * py, qx * qx + qy * qy
    # Half the second derivative along the normal, over the squared slope.
    across_x = 0.5 * (Q[0, 0] * px * px + Q[0, 2] * py * py) + Q[0, 1] * px * py
    across_y = 0.5 * (Q[1, 0] * qx * qx + Q[1, 2] * qy * qy) + Q[1, 1] * qx * qy
    first_bend = (across_x / first2 - away * (h[0] * px + h[1] * py)) / first2
    second_bend = (across_y / second2 - away * (h[0] * qx + h[1] * qy)) / second2
    return SeenPlace(
        Axis(around.at[0] + plain_x + bent_x + state[4] * moved0, state[4] * sqrt(first2), first_bend),
        Axis(around.at[1] + plain_y + bent_y + state[5] * moved1, state[5] * sqrt(second2), second_bend),
        (px, py, qx, qy),
        (moved0, moved1),
    )


@compiled
def blend_at(slopes: tuple[float, float, float, float]) -> tuple[float, float, float]:
    """Return shares of the blurs along a node's diagonal, with a sign for the second, and along the axes."""
    px, py, qx, qy = slopes
    correlation = (px * qx + py * qy) / (hypot(px, py) * hypot(qx, qy))
    size = min(abs(correlation), MOST_OBLIQUE)
    along = sqrt(size)
    return along, along if correlation > 0.0 else -along, sqrt(1.0 - size)


@compiled
def fill_printed(  # noqa: PLR0915 -- one pass over the pixels
    state: np.ndarray,
    pixels: tuple[np.ndarray, np.ndarray],
    around: LocalMap,
    print_: PrintLines,
    rows: Rows,
) -> None:
    """Write residuals, derivatives, pattern and distances at a state.

    Parameters
    ----------
    state : ndarray, shape (PARAMETERS + 1,)
        Of a chessboard's corner, and the share c of ``1 - X^2`` that a tone curve adds to the pattern X.
    pixels : tuple of ndarray
        Offsets (2, n) from where the fit begins, and values (n,).
    around : LocalMap
    print_ : PrintLines
    rows : tuple of ndarray
        Overwritten.
    """
    offset, value = pixels
    residual, jacobian, board, off_edges = rows
    mean, half, gx, gy, tone = state[6], state[7], state[8], state[9], state[10]
    h, terms, off_all = around.perspective, np.empty(_TERMS), sqrt(-2.0 * log(_FLAT))
    # A blur that runs away may reach all lines.
    across, down = np.empty((4, len(print_.x) + 1)), np.empty((4, len(print_.y) + 1))
    nodes = quadrature(most_correlated(offset, around))
    nearest_x = np.searchsorted(print_.x, around.at[0])
    nearest_y = np.searchsorted(print_.y, around.at[1])
    for k in range(len(value)):
        x, y = offset[0, k] - state[0], offset[1, k] - state[1]
        seen = seen_place(state, around, x, y)
        first, second, (px, py, qx, qy) = seen.first, seen.second, seen.slopes
        away = 1.0 / (1.0 + h[0] * x + h[1] * y)
        terms[0], terms[1] = x * away, y * away
        terms[2], terms[3], terms[4] = 0.5 * x * x, x * y, 0.5 * y * y
        near_x, near_y = near_lines(first, print_.x, nearest_x), near_lines(second, print_.y, nearest_y)
        near_x, near_y = seen_lines(near_x, near_y, print_.cells)
        many_x, many_y = near_x[1] - near_x[0], near_y[1] - near_y[0]
        X = by_x = by_y = by_blur0 = by_blur1 = 0.0
        if many_x == 0 and many_y == 0:
            X = print_.cells[near_x[0], near_y[0]]
        else:
            single = many_x == 0 or many_y == 0
            along, sign, left = blend_at(seen.slopes)
            for node in range(1 if single else nodes.shape[1]):
                share = 1.0 if single else nodes[1, node]
                at = 0.0 if single else nodes[0, node]
                rest = 1.0 if single else left
                write_profile(first, near_x, print_.x, (along * at, rest), across)
                write_profile(second, near_y, print_.y, (sign * at, rest), down)
                for i in range(many_x + 1):
                    w = d = e = 0.0
                    for j in range(many_y + 1):
                        cell = print_.cells[near_x[0] + i, near_y[0] + j]
                        w += cell * down[0, j]
                        d += cell * down[1, j]
                        e += cell * down[2, j]
                    X += share * across[0, i] * w
                    by_x += share * across[1, i] * w
                    by_y += share * across[0, i] * d
                    by_blur0 += share * across[2, i] * w
                    by_blur1 += share * across[0, i] * e
        lit = gx * offset[0, k] + gy * offset[1, k]
        light = 1.0 + lit + 0.5 * lit * lit
        toned = X + tone * (1.0 - X * X)
        plain = mean + half * toned
        height = light * half * (1.0 - 2.0 * tone * X)
        jacobian[0, k] = -height * (by_x * px + by_y * qx)
        jacobian[1, k] = -height * (by_x * py + by_y * qy)
        jacobian[2, k] = height * (by_blur0 * first.blur / state[4] + 2.0 * seen.moved[0] * by_x)
        jacobian[3, k] = height * (by_blur1 * second.blur / state[5] + 2.0 * seen.moved[1] * by_y)
        jacobian[4, k] = light
        jacobian[5, k] = light * toned
        for term in range(_TERMS):
            jacobian[_OWN + term, k] = height * by_x * terms[term]
            jacobian[_OWN + _TERMS + term, k] = height * by_y * terms[term]
        residual[k] = value[k] - light * plain
        board[k] = X
        if by_x == 0.0 and by_y == 0.0:
            off_edges[k] = off_all
            continue
        steepest = max(abs(by_x) * first.blur, abs(by_y) * second.blur) / _STEEPEST
        off_edges[k] = sqrt(-2.0 * log(min(max(steepest, _FLAT), 1.0)))


@compiled
def settled_print(
    state: np.ndarray,
    pixels: tuple[np.ndarray, np.ndarray],
    place: tuple[LocalMap, PrintLines, np.ndarray],
    tolerance: float,
    settings: tuple[FitLimits, JudgementLimits],
) -> tuple[float, float]:
    """Iterate a state and its map, in place, to the least squares; return the root mean square residual.

    It is as the last step leaves it by the linear model, and negative if the state runs away. And the error
    of the place along either axis, px. `place` holds, besides, the information on the map's coefficients,
    (2, 5, 2, 5), over that of a pixel. It ends at a step of `tolerance`, px.
    """
    (around, print_, prior), (limits, judgement) = place, settings
    n = len(pixels[1])
    table, normal = np.zeros((ROWS, filled_up(n))), np.empty((ROWS, ROWS))
    rows = table[FREE], table[:FREE], np.empty(n), np.empty(n)
    change, gradient, moved = np.empty(FREE), np.empty(FREE), np.zeros(FREE)
    for _ in range(limits.max_iterations):
        fill_printed(state, pixels, around, print_, rows)
        normal[:] = 0.0
        add_own_products(table, table.shape[1], normal)
        squares = normal[FREE, FREE]
        for i in range(FREE):
            change[i] = normal[FREE, i] - (prior[i] * moved).sum()
            for j in range(i + 1):
                normal[i, j] += prior[i, j]
            normal[i, i] *= 1.0 + _RIDGE
        gradient[:] = change
        if not factorise(normal, FREE, _SINGULAR):
            return -1.0, np.inf
        solve(normal, change)
        if not np.isfinite(change).all():
            return -1.0, np.inf
        far = max(hypot(change[0], change[1]) / limits.max_step_px, 1.0)
        for i in range(_OWN):
            at = _OF_STATE[i]
            new = state[at] + change[i] / far
            if _FIRST_BLUR <= i <= _LAST_BLUR:  # at most doubled or halved
                new = max(min(max(new, 0.5 * state[at]), 2.0 * state[at]), limits.min_blur_px)
            state[at] = new
        for i in range(_OWN, FREE):
            moved[i] += change[i] / far
            axis, term = (i - _OWN) // _TERMS, (i - _OWN) % _TERMS
            if term < _LINEAR:
                around.linear[axis, term] += change[i] / far
            else:
                around.square[axis, term - _LINEAR] += change[i] / far
        if max(abs(change[0]), abs(change[1])) < tolerance:
            rms = sqrt(max(squares - (change * gradient).sum(), 0.0) / n)
            for i in range(FREE):
                table[FREE] -= change[i] * table[i]
            return rms, place_error(table, rows[2], (normal, prior), judgement)
    return -1.0, np.inf
