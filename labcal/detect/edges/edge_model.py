"""Model of a dot's pixels, a blurred step along an ellipse, and its normal equations.

A state is the centre (x, y), the entries xx, xy and yy of the symmetric matrix F that maps the outline to the
unit circle, the blur, and the third harmonic's coefficients c and s: the flattened radius is
``1 + c cos 3a + s sin 3a`` at the angle a, which a bent picture makes of an ellipse and which leaves the
centre of area where it is. The parameters are, in this order, centre 2, ellipse 3 (the matrix E of the
outline ``|(1 + E) F (q - c)| = 1``), blur 1, third harmonic 2, shading of the board 3 and of the dot 3
(level, slopes along the flattened x and y).
"""

from math import sqrt

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.row_products import add_own_products, copy_columns, filled_up

PARAMETERS, STATE, SHADING = 14, 8, 6
CHUNK = 192
"""Pixels that are linearised together, so few that they stay in the nearest cache."""
ROWS, RESIDUAL, BLURS_AWAY, ALONG, PLANES = 3, 17, 18, 19, 20
"""Planes of a chunk: x, y, value, derivatives, residual, blurs from the edge, change with the distance."""
MOMENTS = 13
"""Of the flat pixels on one side: 1, x, y, xx, xy, yy, g, gx, gy, gg, about a place and a level, which come
next."""
FAR = 6.0
"""Blurs from the edge: so far it is all over."""
PRIORS = 4
"""Rows of the priors on what a small dot does not determine: shading across it, and the third harmonic."""
TINY = 1e-30
_THIRD, _SIXTH, _SEVENTH = 1.0 / 3.0, 1.0 / 6.0, 1.0 / 7.0
_SIDE = 4
"""Rows of the flat pixels of one side: 1, x, y, g."""


@compiled
def normal_equations(
    state: np.ndarray,
    shading: np.ndarray,
    edge: np.ndarray,
    moments: np.ndarray,
    expected: tuple[float, float],
    work: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> None:
    """Sum the normal equations, with the priors, over the pixels of the edge and the moments of the others.

    Expected are the standard deviations of the shading across a dot, of its step, a radius, and of the third
    harmonic, a px of radius. The workspace is a chunk, the priors' rows, which are written, and the system
    with the right side below.
    """
    chunk, priors, system = work
    for i in range(PARAMETERS + 2):
        for j in range(PARAMETERS + 2):
            system[i, j] = 0.0
    total = edge.shape[1]
    planes = chunk.reshape(PLANES, CHUNK)
    rows = planes[ROWS : ROWS + PARAMETERS + 2]  # the last for its place: they are taken in pairs
    for first in range(0, total, CHUNK):
        count = min(CHUNK, total - first)
        copy_columns(edge, first, planes, (0, count))
        linearise(state, shading, chunk, count)
        clear_columns(rows, count)
        add_own_products(rows, filled_up(count), system)
    _add_the_rest(state, shading, (moments, total), expected, (priors, system))


@compiled
def clear_columns(rows: np.ndarray, count: int) -> None:
    """Set to 0 what fills rows up behind so many columns; assignment of slices takes longer than that."""
    for i in range(rows.shape[0]):
        row = rows[i]
        for k in range(count, filled_up(count)):
            row[k] = 0.0


@compiled
def _add_the_rest(
    state: np.ndarray,
    shading: np.ndarray,
    pixels: tuple[np.ndarray, int],
    expected: tuple[float, float],
    work: tuple[np.ndarray, np.ndarray],
) -> None:
    """Add the flat pixels and the priors to the normal equations, which hold the edge's pixels."""
    moments, total = pixels
    priors, system = work
    squares = system[PARAMETERS, PARAMETERS] + _add_flat(state, shading, moments, system)
    count = total + moments[0, 0] + moments[1, 0]
    variance = max(squares, 0.0) / (count - PARAMETERS)  # nothing is left of a picture without noise
    _write_priors(state, shading, sqrt(variance), expected, priors)
    for number in range(PRIORS):
        row = priors[number]
        for i in range(PARAMETERS + 1):
            for j in range(min(i + 1, PARAMETERS)):
                system[i, j] += row[i] * row[j]


@compiled
def flattened(state: np.ndarray, x: float, y: float) -> tuple[float, float]:
    """Return where a pixel lies when the outline is the unit circle."""
    dx, dy = x - state[0], y - state[1]
    return state[2] * dx + state[3] * dy, state[3] * dx + state[4] * dy


@compiled
def linearise(state: np.ndarray, shading: np.ndarray, chunk: np.ndarray, count: int) -> None:
    """Write derivatives, residuals, distances and changes of a chunk's pixels into its planes.

    A pixel shows ``B + (D - B) Phi(-distance / blur)``. `chunk` is flat: planes at constant places let the
    compiler take four pixels at a time. Phi is good to seven digits (Abramowitz and Stegun 26.2.17).
    """
    cx, cy, a, b, c, sharp = state[0], state[1], state[2], state[3], state[4], 1.0 / state[5]
    harmonic_c, harmonic_s = state[6], state[7]
    b0, b1, b2, d0, d1, d2 = shading[0], shading[1], shading[2], shading[3], shading[4], shading[5]
    for k in range(count):
        dx, dy = chunk[k] - cx, chunk[CHUNK + k] - cy
        u, v = a * dx + b * dy, b * dx + c * dy
        gx, gy = a * u + b * v, b * u + c * v
        rho2 = u * u + v * v
        rho, slope = sqrt(rho2), sqrt(gx * gx + gy * gy + 1e-18)
        cube = rho2 * rho + 1e-18
        over_both = 1.0 / (cube * slope)  # one division for two: they take longest
        share, over = over_both * cube, over_both * slope
        cosine, sine = u * (u * u - 3.0 * v * v) * over, v * (3.0 * u * u - v * v) * over  # of 3 a
        t = (rho - 1.0 - harmonic_c * cosine - harmonic_s * sine) * rho * share * sharp
        t = min(max(t, -FAR), FAR)
        # exp(-t^2 / 2), as the sixteenth power of a series that ends early.
        x = 0.03125 * t * t
        e = 1.0 - 0.25 * x * (1.0 - 0.2 * x * (1.0 - _SIXTH * x * (1.0 - _SEVENTH * x * (1.0 - 0.125 * x))))
        e = 1.0 - x * (1.0 - 0.5 * x * (1.0 - _THIRD * x * e))
        e = e * e
        e = e * e
        e = e * e
        bell = 0.3989422804014327 * e * e
        q = 1.0 / (1.0 + 0.2316419 * abs(t))
        tail = 1.781477937 + q * (-1.821255978 + q * 1.330274429)
        tail = bell * q * (0.319381530 + q * (-0.356563782 + q * tail))
        inside = tail if t > 0.0 else 1.0 - tail
        outside = 1.0 - inside
        board, dot = b0 + b1 * u + b2 * v, d0 + d1 * u + d2 * v
        along = (board - dot) * bell * sharp
        # rho of the outline (1 + E) F grows by flat' E flat / rho; a distance is rho over its slope.
        pull = along * share
        chunk[3 * CHUNK + k], chunk[4 * CHUNK + k] = -pull * gx, -pull * gy
        chunk[5 * CHUNK + k], chunk[6 * CHUNK + k] = pull * u * u, 2.0 * pull * u * v
        chunk[7 * CHUNK + k], chunk[8 * CHUNK + k] = pull * v * v, -along * t
        harmonic = -pull * rho
        chunk[9 * CHUNK + k], chunk[10 * CHUNK + k] = harmonic * cosine, harmonic * sine
        chunk[11 * CHUNK + k], chunk[12 * CHUNK + k] = outside, outside * u
        chunk[13 * CHUNK + k], chunk[14 * CHUNK + k] = outside * v, inside
        chunk[15 * CHUNK + k], chunk[16 * CHUNK + k] = inside * u, inside * v
        chunk[17 * CHUNK + k] = chunk[2 * CHUNK + k] - outside * board - inside * dot
        chunk[18 * CHUNK + k], chunk[19 * CHUNK + k] = t, along


@compiled
def _write_priors(
    state: np.ndarray,
    shading: np.ndarray,
    noise: float,
    expected: tuple[float, float],
    priors: np.ndarray,
) -> None:
    """Write what is known beforehand as rows of derivatives and residual, weighed like pixels."""
    for i in range(PRIORS):
        for j in range(PARAMETERS + 1):
            priors[i, j] = 0.0
    step = max(abs(shading[3] - shading[0]), TINY)
    for axis in range(2):
        weight = noise / (expected[0] * step)
        priors[axis, STATE + 4 + axis] = weight
        priors[axis, PARAMETERS] = -weight * shading[4 + axis]
        # The third harmonic grows with the radius as the picture bends under the dot.
        weight = noise * sqrt(state[2] * state[4] - state[3] * state[3]) / expected[1]
        priors[2 + axis, 6 + axis] = weight
        priors[2 + axis, PARAMETERS] = -weight * state[6 + axis]


@compiled
def flat_moments(
    start: np.ndarray, shading: np.ndarray, flat: np.ndarray, chunk: np.ndarray, moments: np.ndarray
) -> None:
    """Sum up the flat pixels of the board and of the dot, about the start's centre and levels.

    A flat pixel is linear in the shading, and what it adds to the normal equations follows from its side's
    moments: they are summed up once, however often the fit steps. The chunk is workspace.
    """
    rows, sums = chunk.reshape(PLANES, CHUNK)[: 2 * _SIDE], np.zeros((2 * _SIDE, 2 * _SIDE))
    cx, cy, board, dot = start[0], start[1], shading[0], shading[3]
    for first in range(0, flat.shape[1], CHUNK):
        count = min(CHUNK, flat.shape[1] - first)
        copy_columns(flat, first, chunk.reshape(PLANES, CHUNK)[2 * _SIDE :], (0, count))
        for k in range(count):
            x, y = chunk[8 * CHUNK + k] - cx, chunk[9 * CHUNK + k] - cy
            value = chunk[10 * CHUNK + k]
            u, v = start[2] * x + start[3] * y, start[3] * x + start[4] * y
            inside = 1.0 if u * u + v * v < 1.0 else 0.0
            outside = 1.0 - inside
            chunk[k], chunk[CHUNK + k], chunk[2 * CHUNK + k] = outside, outside * x, outside * y
            chunk[3 * CHUNK + k] = outside * (value - board)
            chunk[4 * CHUNK + k], chunk[5 * CHUNK + k], chunk[6 * CHUNK + k] = inside, inside * x, inside * y
            chunk[7 * CHUNK + k] = inside * (value - dot)
        clear_columns(rows, count)
        for i in range(0, 2 * _SIDE, _SIDE):  # no pixel is on both sides
            add_own_products(rows[i : i + _SIDE], filled_up(count), sums[i : i + _SIDE, i : i + _SIDE])
    for side in range(2):
        i = _SIDE * side
        one, x, y, g, own = sums[i], sums[i + 1], sums[i + 2], sums[i + 3], moments[side]
        own[0], own[1], own[2], own[3], own[4], own[5] = one[i], x[i], y[i], x[i + 1], y[i + 1], y[i + 2]
        own[6], own[7], own[8], own[9] = g[i], g[i + 1], g[i + 2], g[i + 3]
        own[10], own[11], own[12] = start[0], start[1], shading[3 * side]


@compiled
def _add_flat(state: np.ndarray, shading: np.ndarray, moments: np.ndarray, system: np.ndarray) -> float:
    """Add what the flat pixels add to the normal equations; return the sum of their squared residuals."""
    squares = 0.0
    a, b, c = state[2], state[3], state[4]
    for side in range(2):
        n, x, y, xx, xy, yy, g, gx, gy, gg, x0, y0, g0 = moments[side]
        # About the centre, then flattened.
        ex, ey = state[0] - x0, state[1] - y0
        xx, xy, yy = (
            xx - ex * (2.0 * x - n * ex),
            xy - ex * y - ey * (x - n * ex),
            yy - ey * (2.0 * y - n * ey),
        )
        gx, gy, x, y = gx - ex * g, gy - ey * g, x - n * ex, y - n * ey
        u, v, gu, gv = a * x + b * y, b * x + c * y, a * gx + b * gy, b * gx + c * gy
        uu, vv = a * a * xx + 2.0 * a * b * xy + b * b * yy, b * b * xx + 2.0 * b * c * xy + c * c * yy
        uv = a * b * xx + (a * c + b * b) * xy + b * c * yy
        first = 3 * side
        level, slope_u, slope_v = shading[first] - g0, shading[first + 1], shading[first + 2]
        r = g - level * n - slope_u * u - slope_v * v
        ru = gu - level * u - slope_u * uu - slope_v * uv
        rv = gv - level * v - slope_u * uv - slope_v * vv
        squares += gg - level * (g + r) - slope_u * (gu + ru) - slope_v * (gv + rv)
        i = STATE + first
        system[i, i] += n
        system[i + 1, i] += u
        system[i + 1, i + 1] += uu
        system[i + 2, i] += v
        system[i + 2, i + 1] += uv
        system[i + 2, i + 2] += vv
        system[PARAMETERS, i] += r
        system[PARAMETERS, i + 1] += ru
        system[PARAMETERS, i + 2] += rv
    return squares
