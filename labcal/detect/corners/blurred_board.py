"""The pattern of a corner, a blurred chessboard or wedge, at all pixels of a chunk, in compiled code."""

from math import exp, floor, sqrt

import numpy as np

from labcal.detect.compiled import compiled, inlined
from labcal.detect.corners.corner_chunks import (
    AT_A,
    AT_B,
    BOARD,
    BY_A,
    BY_B,
    BY_CORRELATION,
    CHUNK,
    OFF_EDGES,
    PROFILE_A,
    PROFILE_B,
    SLOPE_A,
    SLOPE_B,
    A,
    B,
    Room,
)
from labcal.detect.corners.edge_profile import edge_profile
from labcal.detect.corners.profile_lines import write_profiles

_NOTHING = 16.0
"""exp(-16) of the board's step is nothing."""
_FAR = 9.0
"""The darkness of an edge so many blurs away is nothing."""
_PER_POWER, _GREATEST = 16, 40.0
"""Entries of the table of exponential functions a unit; beyond so many they are nothing."""
_POWERS = np.array([exp(-power / _PER_POWER) for power in range(round(_PER_POWER * _GREATEST) + 2)])
_HALF, _SIXTH, _24TH, _120TH, _720TH = 1 / 2, 1 / 6, 1 / 24, 1 / 120, 1 / 720
_SQUARES, _PRODUCT, _TOTAL, _POWER, _PLACE, _PROFILE, _SLOPE = (CHUNK * line for line in range(7))
"""Beginnings of lines of the workspace for pixels near both edges."""


@compiled
def find_near(room: Room, correlation: float) -> int:
    """Write the numbers of the pixels near both edges, in order, and return how many these are.

    At all others the board is the product of the profiles of its edges.
    """
    kept, near, most = room.kept, room.near, len(room.near) - 1
    farthest, count = 2.0 * _NOTHING / (1.0 - abs(correlation)), 0
    for chunk in range(len(kept)):
        own, first = kept[chunk], chunk * CHUNK
        for k in range(min(CHUNK, most - first)):
            near[count] = first + k
            count += own[A + k] * own[A + k] + own[B + k] * own[B + k] <= farthest
    return count


@compiled
def write_beside(room: Room, count: int, correlation: float, rule: np.ndarray) -> None:
    """Write what both edges together make of so many pixels near both.

    The board is the expectation of ``sign(a + z1) sign(b + z2)`` for standard normal z1, z2. By Plackett's
    identity (1954, Biometrika 41) its derivative by the correlation is four times the density at (a, b); that
    is integrated from correlation 0, where the board is a product. Rows of `beside`: what that adds to it;
    the profile of the second edge along the first one, and its slope; that of the first along the second.
    """
    kept, space, entry, near, beside = room
    per_other = 1.0 / sqrt(1.0 - correlation * correlation)
    for first in range(0, count, CHUNK):
        some = min(CHUNK, count - first)
        for j in range(some):
            own, k = kept[near[first + j] // CHUNK], near[first + j] % CHUNK
            space[AT_A + j], space[AT_B + j] = own[A + k], own[B + k]
        for j in range(some, CHUNK):
            space[AT_A + j] = space[AT_B + j] = 0.0
        _write_integrals(space, entry, rule)
        for j in range(some):
            beside[0, first + j] = space[_TOTAL + j]
        for j in range(CHUNK):
            space[_PLACE + j] = (space[AT_B + j] - correlation * space[AT_A + j]) * per_other
        write_profiles(space, entry, _PLACE, _PROFILE, _SLOPE)
        for j in range(some):
            beside[1, first + j], beside[2, first + j] = space[_PROFILE + j], space[_SLOPE + j] * per_other
        for j in range(CHUNK):
            space[_PLACE + j] = (space[AT_A + j] - correlation * space[AT_B + j]) * per_other
        write_profiles(space, entry, _PLACE, _PROFILE, _SLOPE)
        for j in range(some):
            beside[3, first + j] = space[_PROFILE + j]


@compiled
def _write_integrals(space: np.ndarray, entry: np.ndarray, rule: np.ndarray) -> None:
    """Write the sums of :func:`~labcal.detect.corners.quadrature.quadrature` at a chunk's distances.

    The exponential functions are Taylor's series about the next entry of a table; right to 1e-14.
    """
    for j in range(CHUNK):
        a, b = space[AT_A + j], space[AT_B + j]
        space[_SQUARES + j], space[_PRODUCT + j], space[_TOTAL + j] = 0.5 * (a * a + b * b), a * b, 0.0
    for node in range(rule.shape[1]):
        sine, per_cosine, weight = rule[0, node], rule[1, node], rule[2, node]
        for j in range(CHUNK):
            power = min((space[_SQUARES + j] - space[_PRODUCT + j] * sine) * per_cosine, _GREATEST)
            space[_PLACE + j] = power
            entry[j] = int(_PER_POWER * power + 0.5)
        for j in range(CHUNK):
            space[_POWER + j] = _POWERS[entry[j]]
        for j in range(CHUNK):
            power = space[_PLACE + j]
            d = floor(_PER_POWER * power + 0.5) / _PER_POWER - power
            d2 = d * d
            series = 1.0 + d + d2 * (_HALF + _SIXTH * d + d2 * (_24TH + _120TH * d + d2 * _720TH))
            space[_TOTAL + j] += weight * space[_POWER + j] * series


@compiled
def write_board(room: Room, chunk: int, taken: int, count: int) -> int:
    """Write a blurred chessboard, and its derivatives by both distances and the correlation, of a chunk.

    So many pixels near both edges are in the chunks before, of `count`; return how many in these and this.
    """
    kept, space, entry, near, beside = room
    own = kept[chunk]
    for k in range(CHUNK):
        space[AT_A + k], space[AT_B + k] = own[A + k], own[B + k]
    write_profiles(space, entry, AT_A, PROFILE_A, SLOPE_A)
    write_profiles(space, entry, AT_B, PROFILE_B, SLOPE_B)
    for k in range(CHUNK):
        a, b, slope_a, slope_b = space[AT_A + k], space[AT_B + k], space[SLOPE_A + k], space[SLOPE_B + k]
        space[BOARD + k] = space[PROFILE_A + k] * space[PROFILE_B + k]
        space[BY_A + k] = slope_a if b > 0.0 else -slope_a
        space[BY_B + k] = slope_b if a > 0.0 else -slope_b
        space[BY_CORRELATION + k] = 0.0
        space[OFF_EDGES + k] = min(abs(a), abs(b))
    after = (chunk + 1) * CHUNK
    while taken < count and near[taken] < after:
        k = near[taken] - chunk * CHUNK
        slope_a = space[SLOPE_A + k]
        space[BOARD + k] += beside[0, taken]
        space[BY_A + k], space[BY_CORRELATION + k] = slope_a * beside[1, taken], slope_a * beside[2, taken]
        space[BY_B + k] = space[SLOPE_B + k] * beside[3, taken]
        taken += 1
    return taken


@compiled
def make_wedge(space: np.ndarray) -> None:
    """Make of a chunk's chessboard, and its derivatives, a wedge with the same edges."""
    for k in range(CHUNK):
        both = space[BOARD + k] + space[PROFILE_A + k] + space[PROFILE_B + k]
        space[BOARD + k] = 0.5 - 0.5 * both
        space[BY_A + k] = -0.5 * (space[BY_A + k] + space[SLOPE_A + k])
        space[BY_B + k] = -0.5 * (space[BY_B + k] + space[SLOPE_B + k])
        space[BY_CORRELATION + k] *= -0.5


@compiled
def darken(space: np.ndarray, gap_a: float, gap_b: float) -> None:
    """Take from a chunk's chessboard what markers darken it by, so far away from the edges, in blurs."""
    from_a, from_b, dark = gap_a - _FAR, gap_b - _FAR, 0
    for k in range(CHUNK):
        a, b = space[AT_A + k], space[AT_B + k]
        dark += (a * b > 0.0) & (abs(a) > from_a) & (abs(b) > from_b)
    if dark == 0:
        return
    for k in range(CHUNK):
        a, b = space[AT_A + k], space[AT_B + k]
        if a * b > 0.0 and abs(a) > from_a and abs(b) > from_b:
            space[BOARD + k] -= _darkness(a, b, gap_a, gap_b)


@inlined
def _darkness(a: float, b: float, gap_a: float, gap_b: float) -> float:
    """Return how much markers, so far away from the edges, darken a chessboard there; distances in blurs."""
    profile_a, _ = edge_profile(abs(a) - gap_a)
    profile_b, _ = edge_profile(abs(b) - gap_b)
    return 0.5 * (1.0 + profile_a) * (1.0 + profile_b)
