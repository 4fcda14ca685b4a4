"""Residuals of converged fits along the outline, in harmonics that a fit leaves free, compiled."""

from math import sqrt
from typing import NamedTuple

import numpy as np
from jaxtyping import Int

from labcal.detect.cholesky import factorise, solve
from labcal.detect.compiled import compiled
from labcal.detect.edges.band import pixels_around, without_clutter
from labcal.detect.edges.edge_limits import EdgeLimits
from labcal.detect.edges.edge_model import (
    BLURS_AWAY,
    CHUNK,
    FAR,
    MOMENTS,
    PARAMETERS,
    PLANES,
    PRIORS,
    RESIDUAL,
    ROWS,
    SHADING,
    STATE,
    TINY,
    equations_of,
    flat_moments,
    flattened,
    linearise,
)
from labcal.detect.row_products import HIGH, WIDE, add_products, filled_up

_SINGULAR = 1e-12
_SLOPES = HIGH * -(-(PARAMETERS + 1) // HIGH)
"""Rows of derivatives, of residuals, and of zeros so that they are even in number."""


class Harmonics(NamedTuple):
    """The harmonics ``first, first + stride, ...`` of the angle along the outline, so many terms."""

    first: int
    stride: int
    terms: int

    @property
    def numbers(self) -> Int[np.ndarray, " k"]:
        """Numbers of waves around the outline."""
        return self.first + self.stride * np.arange(self.terms)


@compiled
def harmonic_sums(
    grey: np.ndarray,
    table: np.ndarray,
    weights: np.ndarray,
    picture: tuple[np.ndarray, float],
    numbers: np.ndarray,
    limits: EdgeLimits,
) -> np.ndarray:
    """Return sums of each dot's residuals by harmonic, and the power that white noise would have, (n, k, 3).

    The centre that is stated is a weighted sum of a dot's pixels. For a round dot the weight is a profile
    across the edge times the cosine of the angle. The residuals are summed with the same profile times the
    cosine and the sine of multiples of the angle. The last column is the expected sum of the squares of
    both for noise of variance 1. All is for weights whose squares add up to 1.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
    table : ndarray, shape (n, COLUMNS)
        Converged fits, see :func:`~labcal.detect.edges.gauss_newton.fit_all`.
    weights : ndarray, shape (n, 2, PARAMETERS)
        Weights of the fit's parameters in the centre that is stated.
    picture : (ndarray, float)
        The holes of rings, shape (n,), and how far no other dot is met; radii.
    numbers : ndarray of int, shape (k,)
        Of the harmonics, increasing.
    limits : EdgeLimits

    Returns
    -------
    ndarray, shape (n, k, 3)
        0 where a fit cannot be repeated.
    """
    hole, reach = picture
    sums = np.zeros((len(table), len(numbers), 3))
    system, moments = np.empty((PARAMETERS + 2, PARAMETERS + 2)), np.empty((2, MOMENTS))
    work = np.empty(PLANES * CHUNK), np.empty((PRIORS, PARAMETERS + 1)), system
    expected = limits.prior_shading_share, limits.prior_third_harmonic_per_px
    for number in range(len(table)):
        state, shading = table[number, :STATE], table[number, STATE : STATE + SHADING]
        band = pixels_around(grey, state, (hole[number], reach), limits)
        slopes, found = _slopes(state, shading, band, work[0])
        step = abs(shading[0] - shading[3])
        clean = without_clutter(band, found, step, limits)
        if clean[0].shape[1] < band[0].shape[1]:
            band = clean
            slopes, found = _slopes(state, shading, band, work[0])
        pixels, count = band
        flat_moments(state, shading, pixels[:, count:], moments)
        equations_of(state, shading, (slopes, count), moments, expected, work[1:])
        if not factorise(system, PARAMETERS, _SINGULAR):
            continue
        wanted = weights[number].copy()
        for axis in range(2):
            solve(system, wanted[axis])
        tests = _test_functions(state, band, _combined(wanted, slopes), numbers)
        products = np.zeros((_SLOPES, len(tests)))
        edge = filled_up(count)
        add_products(slopes, tests, (0, edge), products)
        # Flat pixels change with the shading alone, whose rows come last.
        add_products(slopes[STATE:], tests, (edge, slopes.shape[1]), products[STATE:])
        own = (tests[:2] * tests[:2]).sum()  # the same for all harmonics
        _write_sums(products, own, (work[1], system), sums[number])
    return sums


@compiled
def _slopes(
    state: np.ndarray, shading: np.ndarray, band: tuple[np.ndarray, int], chunk: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return rows of the pixels' derivatives by the parameters and of residuals; residual and blurs away.

    The rows, shape (_SLOPES, m), are filled up behind the edge's pixels and behind the flat ones; the second
    array, shape (2, n), is not.
    """
    planes = chunk.reshape(PLANES, CHUNK)
    pixels, total = band
    shift = filled_up(total) - total
    slopes = np.zeros((_SLOPES, total + shift + filled_up(pixels.shape[1] - total)))
    found = np.empty((2, pixels.shape[1]))
    for first in range(0, total, CHUNK):
        count = min(CHUNK, total - first)
        planes[:ROWS, :count] = pixels[:, first : first + count]
        linearise(state, shading, chunk, count)
        slopes[: PARAMETERS + 1, first : first + count] = planes[ROWS : RESIDUAL + 1, :count]
        found[:, first : first + count] = planes[RESIDUAL : BLURS_AWAY + 1, :count]
    for k in range(total, pixels.shape[1]):
        u, v = flattened(state, pixels[0, k], pixels[1, k])
        inside = u * u + v * v < 1.0
        side, at = 3 if inside else 0, k + shift
        slopes[STATE + side, at], slopes[STATE + side + 1, at], slopes[STATE + side + 2, at] = 1.0, u, v
        found[0, k] = pixels[2, k] - shading[side] - shading[side + 1] * u - shading[side + 2] * v
        found[1, k] = -FAR if inside else FAR
        slopes[PARAMETERS, at] = found[0, k]
    return slopes, found


@compiled
def _combined(weights: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """Return the weights of the pixels in the centre, (2, m), from those of the parameters."""
    combined = np.zeros((2, slopes.shape[1]))
    first, second = combined[0], combined[1]
    for i in range(PARAMETERS):
        weight, other, slope = weights[0, i], weights[1, i], slopes[i]
        for k in range(len(slope)):
            first[k] += weight * slope[k]
            second[k] += other * slope[k]
    return combined


@compiled
def _test_functions(
    state: np.ndarray, band: tuple[np.ndarray, int], weights: np.ndarray, numbers: np.ndarray
) -> np.ndarray:
    """Return the profile of the centre's weights times cosine and sine of each harmonic, filled up, (p, m).

    The squares of the cosine and the sine of each add up to 1, unless all weights are 0.
    """
    pixels, edge = band
    tests = np.zeros((WIDE * -(-2 * len(numbers) // WIDE), weights.shape[1]))
    _write_tests(state, pixels[:, :edge], weights[:, :edge], numbers, tests[:, :edge])
    first, flat = filled_up(edge), pixels.shape[1] - edge
    _write_tests(
        state,
        pixels[:, edge:],
        weights[:, first : first + flat],
        numbers,
        tests[:, first : first + flat],
    )
    tests /= sqrt(max((tests[:2] * tests[:2]).sum(), TINY))
    return tests


@compiled
def _write_tests(
    state: np.ndarray, pixels: np.ndarray, weights: np.ndarray, numbers: np.ndarray, tests: np.ndarray
) -> None:
    """Write test functions of some pixels, not yet scaled.

    They are computed for a chunk at a time: places at constant distances let the compiler take several pixels
    together. A chunk of complex numbers has the imaginary parts behind the real ones.
    """
    a, b, c = state[2], state[3], state[4]
    chunk, turn, wave = np.zeros(4 * CHUNK), np.zeros(2 * CHUNK), np.zeros(2 * CHUNK)
    last, step, spare = np.zeros(2 * CHUNK), np.zeros(2 * CHUNK), np.zeros(2 * CHUNK)
    for first in range(0, pixels.shape[1], CHUNK):
        count = min(CHUNK, pixels.shape[1] - first)
        for row in range(2):
            chunk[row * CHUNK : row * CHUNK + count] = pixels[row, first : first + count] - state[row]
            chunk[(2 + row) * CHUNK : (2 + row) * CHUNK + count] = weights[row, first : first + count]
        for k in range(CHUNK):
            dx, dy, wx, wy = chunk[k], chunk[CHUNK + k], chunk[2 * CHUNK + k], chunk[3 * CHUNK + k]
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
            tests[2 * j, first : first + count] = wave[:count]
            tests[2 * j + 1, first : first + count] = wave[CHUNK : CHUNK + count]
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


@compiled
def _write_sums(
    products: np.ndarray, own: float, fit: tuple[np.ndarray, np.ndarray], sums: np.ndarray
) -> None:
    """Write one dot's sums, from the products of derivatives and residuals with test functions.

    `own` is the sum of the squares of a harmonic's test functions, `fit` holds the priors' rows and the
    factorised system. A fit takes from a test function `t` what it can follow: of white noise
    ``t't - t'G inv(A) G't - |P inv(A) G't|^2`` is left, for derivatives G, priors P and A = G'G + P'P.
    """
    priors, system = fit
    for harmonic in range(len(sums)):
        left = own
        for test in range(2 * harmonic, 2 * harmonic + 2):
            left -= _followed(products[:PARAMETERS, test].copy(), priors, system)
            sums[harmonic, test - 2 * harmonic] = products[PARAMETERS, test]
        sums[harmonic, 2] = max(left, 0.0)


@compiled
def _followed(products: np.ndarray, priors: np.ndarray, system: np.ndarray) -> float:
    """Return the power of white noise that a fit takes from a test function, by its products with slopes."""
    solved, power = products.copy(), 0.0
    solve(system, solved)
    for i in range(PARAMETERS):
        power += products[i] * solved[i]
    for row in range(PRIORS):
        held = 0.0
        for i in range(PARAMETERS):
            held += priors[row, i] * solved[i]
        power += held * held
    return power
