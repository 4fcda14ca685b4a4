"""The blurred print around a corner and its fit, in compiled code; what they mean stands at `printed_fit`."""

from math import hypot, log, sqrt
from typing import NamedTuple

import numpy as np

from labcal.detect.cholesky import factorise, solve
from labcal.detect.compiled import compiled
from labcal.detect.corners.corner_judgement import JudgementLimits, place_error
from labcal.detect.corners.corner_kernel import FitLimits
from labcal.detect.corners.printed_place import (
    LocalMap,
    blend_at,
    most_correlated,
    seen_place,
    unlit_place,
    widest_blurs,
)
from labcal.detect.corners.printed_profile import (
    Axis,
    near_lines,
    quadrature,
    seen_lines,
    write_profile,
)
from labcal.detect.corners.tone_curve import tone_terms, toned
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
        Of a chessboard's corner, and the c of a :mod:`~labcal.detect.corners.tone_curve`.
    pixels : tuple of ndarray
        Offsets (2, n) from where the fit begins, and values (n,).
    around : LocalMap
    print_ : PrintLines
    rows : tuple of ndarray
        Overwritten.
    """
    offset, value = pixels
    residual, jacobian, board, off_edges = rows
    mean, half, gx, gy, terms_of_tone = state[6], state[7], state[8], state[9], tone_terms(state[10])
    h, terms, off_all = around.perspective, np.empty(_TERMS), sqrt(-2.0 * log(_FLAT))
    # A blur that runs away may reach all lines.
    across, down = np.empty((4, len(print_.x) + 1)), np.empty((4, len(print_.y) + 1))
    nodes = quadrature(most_correlated(offset, around))
    widest = widest_blurs(state, offset, around)
    nearest_x = np.searchsorted(print_.x, around.at[0])
    nearest_y = np.searchsorted(print_.y, around.at[1])
    for k in range(len(value)):
        x, y = offset[0, k] - state[0], offset[1, k] - state[1]
        place = unlit_place(around, x, y)
        near_x = near_lines(Axis(place[0], widest[0], 0.0), print_.x, nearest_x)
        near_y = near_lines(Axis(place[1], widest[1], 0.0), print_.y, nearest_y)
        near_x, near_y = seen_lines(near_x, near_y, print_.cells)
        many_x, many_y = near_x[1] - near_x[0], near_y[1] - near_y[0]
        lit = gx * offset[0, k] + gy * offset[1, k]
        light = 1.0 + lit + 0.5 * lit * lit
        if many_x == 0 and many_y == 0:
            X = print_.cells[near_x[0], near_y[0]]
            for p in range(FREE):
                jacobian[p, k] = 0.0
            jacobian[4, k], jacobian[5, k] = light, light * X
            residual[k], board[k], off_edges[k] = value[k] - light * (mean + half * X), X, off_all
            continue
        seen = seen_place(state, around, (x, y), place)
        first, second, (px, py, qx, qy) = seen.first, seen.second, seen.slopes
        away = 1.0 / (1.0 + h[0] * x + h[1] * y)
        terms[0], terms[1] = x * away, y * away
        terms[2], terms[3], terms[4] = 0.5 * x * x, x * y, 0.5 * y * y
        X = by_x = by_y = by_blur0 = by_blur1 = 0.0
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
        pattern, steepness = toned(X, terms_of_tone)
        plain = mean + half * pattern
        height = light * half * steepness
        jacobian[0, k] = -height * (by_x * px + by_y * qx)
        jacobian[1, k] = -height * (by_x * py + by_y * qy)
        jacobian[2, k] = height * (by_blur0 * first.blur / state[4] + 2.0 * seen.moved[0] * by_x)
        jacobian[3, k] = height * (by_blur1 * second.blur / state[5] + 2.0 * seen.moved[1] * by_y)
        jacobian[4, k] = light
        jacobian[5, k] = light * pattern
        for term in range(_TERMS):
            jacobian[_OWN + term, k] = height * by_x * terms[term]
            jacobian[_OWN + _TERMS + term, k] = height * by_y * terms[term]
        residual[k] = value[k] - light * plain
        board[k] = X
        steepest = max(abs(by_x) * first.blur, abs(by_y) * second.blur) / _STEEPEST
        off_edges[k] = sqrt(-2.0 * log(min(max(steepest, _FLAT), 1.0)))


@compiled
def _take_step(state: np.ndarray, around: LocalMap, step: np.ndarray, least_blur: float) -> None:
    """Add a step to free parameters of a state and of the map, in place; blurs double or halve at most."""
    for i in range(_OWN):
        at = _OF_STATE[i]
        new = state[at] + step[i]
        if _FIRST_BLUR <= i <= _LAST_BLUR:
            new = max(min(max(new, 0.5 * state[at]), 2.0 * state[at]), least_blur)
        state[at] = new
    for i in range(_OWN, FREE):
        axis, term = (i - _OWN) // _TERMS, (i - _OWN) % _TERMS
        if term < _LINEAR:
            around.linear[axis, term] += step[i]
        else:
            around.square[axis, term - _LINEAR] += step[i]


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
        step = change / far
        _take_step(state, around, step, limits.min_blur_px)
        moved[_OWN:] += step[_OWN:]
        if max(abs(change[0]), abs(change[1])) < tolerance:
            rms = sqrt(max(squares - (change * gradient).sum(), 0.0) / n)
            for i in range(FREE):
                table[FREE] -= change[i] * table[i]
            return rms, place_error(table, rows[2], (normal, prior), judgement)
    return -1.0, np.inf
