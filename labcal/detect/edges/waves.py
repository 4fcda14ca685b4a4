"""Waves along a dot's outline, with the profile of its centre's weights across the edge, compiled."""

from math import sqrt

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.edges.edge_model import CHUNK, TINY
from labcal.detect.row_products import WIDE, copy_columns, filled_up


@compiled
def wave_functions(
    state: np.ndarray,
    band: tuple[np.ndarray, int],
    weights: np.ndarray,
    numbers: np.ndarray,
    space: np.ndarray,
) -> np.ndarray:
    """Return the profile of the centre's weights times cosine and sine of each harmonic, filled up, (p, m).

    The squares of both have the same sum for all harmonics.

    Parameters
    ----------
    state : ndarray, shape (STATE,)
    band : (ndarray, int)
        Pixels, shape (3, n), and how many of them are the edge's.
    weights : ndarray, shape (2, m)
        Of the pixels in the centre; those behind the edge's and behind the flat ones are 0.
    numbers : ndarray of int, shape (k,)
        Of the harmonics, increasing.
    space : ndarray
        Room for the result, overwritten.
    """
    pixels, edge = band
    count, width = WIDE * -(-2 * len(numbers) // WIDE), weights.shape[1]
    tests = space[: count * width].reshape(count, width)
    tests[2 * len(numbers) :] = 0.0
    _write_tests(state, pixels[:2, :edge], weights[:, :edge], numbers, tests[:, :edge])
    flat = slice(filled_up(edge), filled_up(edge) + pixels.shape[1] - edge)
    tests[:, edge : flat.start], tests[:, flat.stop :] = 0.0, 0.0
    _write_tests(state, pixels[:2, edge:], weights[:, flat], numbers, tests[:, flat])
    return tests


@compiled
def _write_tests(
    state: np.ndarray, pixels: np.ndarray, weights: np.ndarray, numbers: np.ndarray, tests: np.ndarray
) -> None:
    """Write test functions of some pixels.

    They are computed for a chunk at a time: places at constant distances let the compiler take several pixels
    together. A chunk of complex numbers has the imaginary parts behind the real ones.
    """
    a, b, c = state[2], state[3], state[4]
    chunk, turn, wave = np.zeros(4 * CHUNK), np.zeros(2 * CHUNK), np.zeros(2 * CHUNK)
    planes = chunk.reshape(4, CHUNK)
    last, step, spare = np.zeros(2 * CHUNK), np.zeros(2 * CHUNK), np.zeros(2 * CHUNK)
    for first in range(0, pixels.shape[1], CHUNK):
        count = min(CHUNK, pixels.shape[1] - first)
        copy_columns(pixels, first, planes, (0, count))
        copy_columns(weights, first, planes[2:], (0, count))
        for k in range(CHUNK):
            dx, dy = chunk[k] - state[0], chunk[CHUNK + k] - state[1]
            wx, wy = chunk[2 * CHUNK + k], chunk[3 * CHUNK + k]
            u, v = a * dx + b * dy, b * dx + c * dy
            share = 1.0 / sqrt(u * u + v * v + TINY)
            cosine, sine = u * share, v * share
            turn[k], turn[CHUNK + k] = cosine, sine
            # The weight of a shift away from the centre.
            last[k], last[CHUNK + k] = (a * wx + b * wy) * cosine + (b * wx + c * wy) * sine, 0.0
        apart = 0
        for j in range(len(numbers)):
            further = numbers[j] - (numbers[j - 1] if j > 0 else 0)
            if further != apart:
                apart = further
                _power(turn, apart, step, spare)
            _multiply(last, step, wave)
            cosine_row, sine_row = tests[2 * j], tests[2 * j + 1]
            for k in range(count):
                cosine_row[first + k], sine_row[first + k] = wave[k], wave[CHUNK + k]
            last, wave = wave, last


@compiled
def _power(turn: np.ndarray, exponent: int, result: np.ndarray, spare: np.ndarray) -> None:
    """Write powers of a chunk of complex numbers, with an exponent of at least 1; `spare` is overwritten."""
    result[:] = turn
    bit = 1
    while 2 * bit <= exponent:
        bit *= 2
    while bit > 1:
        bit //= 2
        spare[:] = result
        _multiply(spare, spare, result)
        if exponent & bit:
            spare[:] = result
            _multiply(spare, turn, result)


@compiled
def _multiply(one: np.ndarray, other: np.ndarray, result: np.ndarray) -> None:
    """Write the products of two chunks of complex numbers."""
    for k in range(CHUNK):
        a, b, c, d = one[k], one[CHUNK + k], other[k], other[CHUNK + k]
        result[k], result[CHUNK + k] = a * c - b * d, a * d + b * c
