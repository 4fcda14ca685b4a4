"""The blurred pattern of a corner and its fit, in compiled code; what they mean stands at `corner_model`."""

from math import cos, hypot, sin, sqrt
from typing import NamedTuple

import numpy as np

from labcal.detect.cholesky import factorise, solve
from labcal.detect.compiled import compiled
from labcal.detect.corners.blurred_board import (
    darken,
    find_near,
    make_wedge,
    write_beside,
    write_board,
)
from labcal.detect.corners.corner_chunks import BOARD, CHUNK, OFF_EDGES, A, B, Room, X, Y, room_of
from labcal.detect.corners.corner_rows import RESIDUAL, ROWS, Turned, write_distances, write_rows
from labcal.detect.corners.quadrature import quadrature
from labcal.detect.corners.tone_curve import tone_chunk
from labcal.detect.row_products import add_own_products, copy_columns, filled_up

PARAMETERS = 10
"""Corner 2, angles of the edges' normals 2, blurs 2, mean, half step, slope of the light 2."""
_FIRST_BLUR, _LAST_BLUR = 4, 5
LIGHT_KNOWN = 8
"""Free parameters of a fit that takes the slope of the light, the last two, for known."""
CHESSBOARD, WEDGE = 0, 1
"""Patterns: a chessboard of -1 and 1; a black wedge on white."""
_MOST_OBLIQUE = 0.999
"""Cosine of the angle between the edges."""
_RIDGE = 1e-9
_SINGULAR = 1e-12


class FitLimits(NamedTuple):
    """The settings of corners that the fit takes."""

    max_iterations: int
    max_step_px: float
    max_turn_rad: float
    min_blur_px: float


Pixels = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, int, float]
"""Offsets (2, n), values (n,), gap (2,), bend (2,), the pattern and the tone of
:class:`labcal.detect.corners.corner_model.CornerPixels`."""


@compiled
def pattern_values(u: np.ndarray, correlation: float, gap: np.ndarray, pattern: int) -> np.ndarray:
    """Return a pattern at distances u (2, n) from its edges, with markers `gap` (2,) away; all in blurs."""
    n, values = u.shape[1], np.empty(u.shape[1])
    room = room_of(u, values)
    for chunk in range(len(room.kept)):
        own = room.kept[chunk]
        own[A : A + CHUNK], own[B : B + CHUNK] = own[X : X + CHUNK], own[Y : Y + CHUNK]
    near, taken = find_near(room, correlation), 0
    write_beside(room, near, correlation, quadrature(correlation))
    for chunk in range(len(room.kept)):
        taken, first = write_board(room, chunk, taken, near), chunk * CHUNK
        if pattern == WEDGE:
            make_wedge(room.space)
        else:
            darken(room.space, gap[0], gap[1])
        for k in range(min(CHUNK, n - first)):
            values[first + k] = room.space[BOARD + k]
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
    residual, jacobian, board, off_edges = rows
    room, n = room_of(pixels[0], pixels[1]), len(pixels[1])
    lines = room.space.reshape(-1, CHUNK)
    turned, near = _prepared(state, pixels, room)
    taken = 0
    for chunk in range(len(room.kept)):
        taken, at = _linearised(state, pixels, (room, turned), (chunk, taken, near)), chunk * CHUNK
        count = min(CHUNK, n - at)
        copy_columns(lines[:PARAMETERS], 0, jacobian, (at, count))
        for k in range(count):
            residual[at + k] = room.space[RESIDUAL * CHUNK + k]
            board[at + k], off_edges[at + k] = room.space[BOARD + k], room.space[OFF_EDGES + k]


@compiled
def _prepared(state: np.ndarray, pixels: Pixels, room: Room) -> tuple[Turned, int]:
    """Write what the chunks of a corner need of each other; return angles and the number of pixels near."""
    turned = cos(state[2]), sin(state[2]), cos(state[3]), sin(state[3])
    for chunk in range(len(room.kept)):
        write_distances(state, turned, pixels[3], room.kept[chunk])
    correlation = min(max(cos(state[2] - state[3]), -_MOST_OBLIQUE), _MOST_OBLIQUE)
    near = find_near(room, correlation)
    write_beside(room, near, correlation, quadrature(correlation))
    return turned, near


@compiled
def _linearised(
    state: np.ndarray, pixels: Pixels, around: tuple[Room, Turned], numbers: tuple[int, int, int]
) -> int:
    """Write the rows of a chunk; return how many pixels near both edges are in the chunks up to this one.

    `numbers` are that of the chunk, of such pixels before it, and of all these.
    """
    room, turned = around
    chunk, taken, near = numbers
    taken = write_board(room, chunk, taken, near)
    if pixels[4] == WEDGE:
        make_wedge(room.space)
    else:
        darken(room.space, pixels[2][0] / state[4], pixels[2][1] / state[5])
    if pixels[5] != 0.0:
        tone_chunk(room.space, pixels[5])
    write_rows(state, turned, room.kept[chunk], room.space)
    return taken


@compiled
def _write_normal(state: np.ndarray, pixels: Pixels, room: Room, normal: np.ndarray) -> None:
    """Write the products of the derivatives and residuals at a state with one another, (ROWS, ROWS)."""
    n, lines, taken = len(pixels[1]), room.space.reshape(-1, CHUNK)[:ROWS], 0
    turned, near = _prepared(state, pixels, room)
    for k in range(CHUNK):
        lines[RESIDUAL + 1, k] = 0.0
    for i in range(ROWS):
        for j in range(ROWS):
            normal[i, j] = 0.0
    for chunk in range(len(room.kept)):
        taken = _linearised(state, pixels, (room, turned), (chunk, taken, near))
        count = min(CHUNK, n - chunk * CHUNK)
        width = filled_up(count)
        for row in range(RESIDUAL + 1):
            for k in range(count, width):
                lines[row, k] = 0.0
        add_own_products(lines, width, normal)


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
    n, room = len(pixels[1]), room_of(pixels[0], pixels[1])
    change, gradient = np.zeros(PARAMETERS), np.empty(PARAMETERS)
    for _ in range(limits.max_iterations):
        _write_normal(state, pixels, room, normal)
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
