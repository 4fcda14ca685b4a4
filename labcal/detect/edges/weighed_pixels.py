"""Sums over the pixels of a dot with the weights that they have in its centre, by harmonic, compiled."""

from math import sqrt

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.edges.edge_model import (
    CHUNK,
    PARAMETERS,
    PLANES,
    RESIDUAL,
    ROWS,
    SHADING,
    STATE,
    TINY,
    clear_columns,
    linearise,
)
from labcal.detect.row_products import HIGH, WIDE, add_products, copy_columns, filled_up

_PROFILE, _SHARES, _TURN, _STEP, _WAVE, _TESTS = 0, 1, 2, 4, 6, 8
LINES = _TESTS + WIDE
"""Lines of a chunk: weight of a shift away from the centre; the residual times it; the angle, a power of
it and a harmonic as complex numbers; test functions of the first harmonic."""


@compiled
def weighed_sums(
    row: np.ndarray,
    band: tuple[np.ndarray, np.ndarray],
    wanted: np.ndarray,
    numbers: np.ndarray,
    results: tuple[np.ndarray, np.ndarray],
    work: tuple[np.ndarray, np.ndarray],
) -> None:
    """Sum the residuals of a fit's pixels, with their weights in the centre, by harmonic.

    The pixels are gone through once, in chunks that stay in the nearest cache.

    Parameters
    ----------
    row : ndarray
        State and shading of a fit.
    band : (ndarray, ndarray)
        Pixels of several dots, shape (3, n), and the first one of this dot, the number of those of its edge,
        which come first, and that of all.
    wanted : ndarray, shape (2, PARAMETERS)
        Weights of the derivatives of the pixels in the centre.
    numbers : ndarray of int, shape (k,)
        Of the harmonics, increasing.
    results : (ndarray, ndarray)
        Overwritten. Shape (2, 1 + 2 k, filled up): first, above, the sum of the squares of all weights; then,
        below, the sums of residuals by cosine and sine of each harmonic. Shape (16, 4): the products of the
        derivatives with both test functions of the first harmonic; none if this is empty.
    work : (ndarray, ndarray)
        Workspace of PLANES chunks, and of LINES chunks and one more for each column of the first result.
        Zeros before the first call.
    """
    pixels, at, edge, total = band[0], band[1][0], band[1][1], band[1][2]
    state, shading = row[:STATE], row[STATE : STATE + SHADING]
    products, followed = results
    for sums in results:
        for i in range(sums.shape[0]):
            for j in range(sums.shape[1]):
                sums[i, j] = 0.0
    chunk, space = work
    planes, lines = chunk.reshape(PLANES, CHUNK), space.reshape(-1, CHUNK)
    waves = lines[LINES:]
    first = 0
    while first < total:
        flat = first >= edge
        count = min(CHUNK, (total if flat else edge) - first)
        width, begin = filled_up(count), STATE if flat else 0
        copy_columns(pixels, at + first, planes, (0, count))
        if flat:
            _level(state, shading, chunk, count)
        else:
            linearise(state, shading, chunk, count)
        clear_columns(planes, count)
        _weigh(state, wanted, (planes[ROWS + begin :], begin), (chunk, space), width)
        _write_waves(space, numbers, width)
        add_products(lines[:HIGH], waves, (0, width), products)
        if len(followed) > 0:
            for k in range(width):
                lines[_TESTS, k] = lines[_PROFILE, k] * waves[1, k]
                lines[_TESTS + 1, k] = lines[_PROFILE, k] * waves[2, k]
            derivatives = planes[ROWS + begin : ROWS + PARAMETERS + HIGH]
            add_products(derivatives, lines[_TESTS:LINES], (0, width), followed[begin:])
        first += count


@compiled
def _level(state: np.ndarray, shading: np.ndarray, chunk: np.ndarray, count: int) -> None:
    """Write the derivatives by the shading and residuals of flat pixels as for those of an edge."""
    cx, cy, a, b, c = state[0], state[1], state[2], state[3], state[4]
    b0, b1, b2, d0, d1, d2 = shading[0], shading[1], shading[2], shading[3], shading[4], shading[5]
    for k in range(count):
        dx, dy = chunk[k] - cx, chunk[CHUNK + k] - cy
        u, v = a * dx + b * dy, b * dx + c * dy
        inside = 1.0 if u * u + v * v < 1.0 else 0.0
        outside = 1.0 - inside
        chunk[11 * CHUNK + k], chunk[12 * CHUNK + k] = outside, outside * u
        chunk[13 * CHUNK + k], chunk[14 * CHUNK + k] = outside * v, inside
        chunk[15 * CHUNK + k], chunk[16 * CHUNK + k] = inside * u, inside * v
        shown = outside * (b0 + b1 * u + b2 * v) + inside * (d0 + d1 * u + d2 * v)
        chunk[17 * CHUNK + k] = chunk[2 * CHUNK + k] - shown


@compiled
def _weigh(
    state: np.ndarray,
    wanted: np.ndarray,
    derivatives: tuple[np.ndarray, int],
    work: tuple[np.ndarray, np.ndarray],
    width: int,
) -> None:
    """Write the weights of a chunk's pixels away from the centre, residuals times them, and the angles.

    `derivatives` are rows of them, and the number of the first one.
    """
    rows, begin = derivatives
    chunk, space = work
    a, b, c = state[2], state[3], state[4]
    lines = space.reshape(-1, CHUNK)
    along_x, along_y = lines[_WAVE], lines[_WAVE + 1]
    for k in range(width):
        along_x[k] = along_y[k] = 0.0
    for i in range(begin, PARAMETERS, 2):  # two at a time: the sums are written half as often
        _add_pair(along_x, (wanted[0, i], wanted[0, i + 1]), (rows[i - begin], rows[i - begin + 1]), width)
        _add_pair(along_y, (wanted[1, i], wanted[1, i + 1]), (rows[i - begin], rows[i - begin + 1]), width)
    for k in range(width):
        dx, dy = chunk[k] - state[0], chunk[CHUNK + k] - state[1]
        wx, wy = space[_WAVE * CHUNK + k], space[(_WAVE + 1) * CHUNK + k]
        u, v = a * dx + b * dy, b * dx + c * dy
        share = 1.0 / sqrt(u * u + v * v + TINY)
        cosine, sine = u * share, v * share
        profile = (a * wx + b * wy) * cosine + (b * wx + c * wy) * sine
        space[_PROFILE * CHUNK + k] = profile
        space[_SHARES * CHUNK + k] = profile * chunk[RESIDUAL * CHUNK + k]
        space[_TURN * CHUNK + k], space[(_TURN + 1) * CHUNK + k] = cosine, sine


@compiled
def _add_pair(
    sums: np.ndarray, weights: tuple[float, float], rows: tuple[np.ndarray, np.ndarray], width: int
) -> None:
    """Add two rows, weighted, to sums."""
    (one, other), (first, second) = weights, rows
    for k in range(width):
        sums[k] = (sums[k] + one * first[k]) + other * second[k]


@compiled
def _write_waves(space: np.ndarray, numbers: np.ndarray, width: int) -> None:
    """Write the weights away from the centre, and cosine and sine of every harmonic, into the last lines."""
    lines = space.reshape(-1, CHUNK)
    copy_columns(lines[_PROFILE : _PROFILE + 1], 0, lines[LINES:], (0, width))
    apart, step = 0, space[_STEP * CHUNK :]
    for j in range(len(numbers)):
        further = numbers[j] - (numbers[j - 1] if j > 0 else 0)
        if further != apart:
            apart = further
            _power(space, apart, width)
        first = LINES + 1 + 2 * j
        if j == 0:
            copy_columns(lines[_STEP : _STEP + 2], 0, lines[first:], (0, width))
        else:
            _turn_on(space[(first - 2) * CHUNK :], step, space[first * CHUNK :], width)


@compiled
def _turn_on(before: np.ndarray, step: np.ndarray, after: np.ndarray, width: int) -> None:
    """Write the products of complex numbers; each array holds a line of real parts and one of imaginary."""
    for k in range(width):
        a, b, c, d = before[k], before[CHUNK + k], step[k], step[CHUNK + k]
        after[k], after[CHUNK + k] = a * c - b * d, a * d + b * c


@compiled
def _power(space: np.ndarray, exponent: int, width: int) -> None:
    """Write the step that is a power of the angle, with an exponent of at least 1.

    Lines at constant places let the compiler take several pixels at a time.
    """
    lines = space.reshape(-1, CHUNK)
    copy_columns(lines[_TURN : _TURN + 2], 0, lines[_STEP:], (0, width))
    bit = 1
    while 2 * bit <= exponent:
        bit *= 2
    while bit > 1:
        bit //= 2
        for k in range(width):
            a, b = space[_STEP * CHUNK + k], space[(_STEP + 1) * CHUNK + k]
            space[_STEP * CHUNK + k], space[(_STEP + 1) * CHUNK + k] = a * a - b * b, 2.0 * a * b
        if exponent & bit:
            for k in range(width):
                a, b = space[_STEP * CHUNK + k], space[(_STEP + 1) * CHUNK + k]
                c, d = space[_TURN * CHUNK + k], space[(_TURN + 1) * CHUNK + k]
                space[_STEP * CHUNK + k], space[(_STEP + 1) * CHUNK + k] = a * c - b * d, a * d + b * c
