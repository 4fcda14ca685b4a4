"""Residuals of converged fits along the outline, in harmonics that a fit leaves free, compiled."""

from math import sqrt
from typing import NamedTuple

import numpy as np
from jaxtyping import Int

from labcal.detect.cholesky import factorise, solve, solve_columns
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
from labcal.detect.edges.waves import wave_functions
from labcal.detect.row_products import HIGH, LANES, WIDE, add_products, add_tile, copy_columns, filled_up

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
    tests_count = WIDE * -(-2 * len(numbers) // WIDE)
    spaces = np.empty(0), np.empty(0)
    room = 0  # for so many pixels; memory that is allocated dot by dot comes page by page
    for number in range(len(table)):
        state, shading = table[number, :STATE], table[number, STATE : STATE + SHADING]
        band = pixels_around(grey, state, (hole[number], reach), limits)
        if band[0].shape[1] > room:
            room = 2 * band[0].shape[1]
            spaces = np.empty(_SLOPES * (room + 2 * LANES)), np.empty(tests_count * (room + 2 * LANES))
        slopes, found = _slopes(state, shading, band, work[0], spaces[0])
        step = abs(shading[0] - shading[3])
        clean = without_clutter(band, found, step, limits)
        if clean[0].shape[1] < band[0].shape[1]:
            band = clean
            slopes, found = _slopes(state, shading, band, work[0], spaces[0])
        pixels, count = band
        flat_moments(state, shading, pixels[:, count:], moments)
        equations_of(state, shading, (slopes, count), moments, expected, work[1:])
        if not factorise(system, PARAMETERS, _SINGULAR):
            continue
        wanted = weights[number].copy()
        for axis in range(2):
            solve(system, wanted[axis])
        tests = wave_functions(state, band, _combined(wanted, slopes), numbers, spaces[1])
        products = np.zeros((_SLOPES, len(tests)))
        edge = filled_up(count)
        add_products(slopes, tests, (0, edge), products)
        # Flat pixels change with the shading alone, whose rows come last.
        add_products(slopes[STATE:], tests, (edge, slopes.shape[1]), products[STATE:])
        squares = np.zeros((HIGH, WIDE))
        add_tile(tests[:HIGH], tests[:WIDE], (0, tests.shape[1]), squares)
        own = squares[0, 0] + squares[1, 1]  # the same for all harmonics
        products /= sqrt(max(own, TINY))
        _write_sums(products, min(own / TINY, 1.0), (work[1], system), sums[number])
    return sums


@compiled
def _slopes(
    state: np.ndarray,
    shading: np.ndarray,
    band: tuple[np.ndarray, int],
    chunk: np.ndarray,
    space: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Return rows of the pixels' derivatives by the parameters and of residuals; residual and blurs away.

    The rows, shape (_SLOPES, m) in `space`, are filled up behind the edge's pixels and behind the flat ones;
    the second array, shape (2, n), is not.
    """
    planes = chunk.reshape(PLANES, CHUNK)
    pixels, total = band
    shift = filled_up(total) - total
    width = total + shift + filled_up(pixels.shape[1] - total)
    slopes = space[: _SLOPES * width].reshape(_SLOPES, width)
    slopes[:, total:] = 0.0
    slopes[PARAMETERS + 1 :] = 0.0
    found = np.empty((2, pixels.shape[1]))
    for first in range(0, total, CHUNK):
        count = min(CHUNK, total - first)
        copy_columns(pixels, first, planes, (0, count))
        linearise(state, shading, chunk, count)
        copy_columns(planes[ROWS : RESIDUAL + 1], 0, slopes, (first, count))
        copy_columns(planes[RESIDUAL : BLURS_AWAY + 1], 0, found, (first, count))
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
def _write_sums(
    products: np.ndarray, own: float, fit: tuple[np.ndarray, np.ndarray], sums: np.ndarray
) -> None:
    """Write one dot's sums, from the products of derivatives and residuals with test functions.

    `own` is the sum of the squares of a harmonic's test functions, `fit` holds the priors' rows and the
    factorised system. A fit takes from a test function `t` what it can follow: of white noise
    ``t't - t'G inv(A) G't - |P inv(A) G't|^2`` is left, for derivatives G, priors P and A = G'G + P'P.
    """
    priors, system = fit
    solved = products[:PARAMETERS].copy()
    solve_columns(system, solved)
    power = np.zeros(products.shape[1])
    for i in range(PARAMETERS):
        for test in range(len(power)):
            power[test] += products[i, test] * solved[i, test]
    for row in range(PRIORS):
        for test in range(len(power)):
            held = 0.0
            for i in range(PARAMETERS):
                held += priors[row, i] * solved[i, test]
            power[test] += held * held
    for harmonic in range(len(sums)):
        for part in range(2):
            sums[harmonic, part] = products[PARAMETERS, 2 * harmonic + part]
        sums[harmonic, 2] = max(own - power[2 * harmonic] - power[2 * harmonic + 1], 0.0)
