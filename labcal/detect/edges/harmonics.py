"""Residuals of converged fits along the outline, in harmonics that a fit leaves free, compiled."""

from math import sqrt
from typing import NamedTuple

import numpy as np

from labcal.detect.cholesky import factorise, solve
from labcal.detect.compiled import compiled
from labcal.detect.edges.band import pixels_around, without_clutter
from labcal.detect.edges.edge_limits import EdgeLimits
from labcal.detect.edges.edge_model import (
    ALONG,
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
    flat_moments,
    flattened,
    linearise,
    normal_equations,
)

_SINGULAR = 1e-12


class Harmonics(NamedTuple):
    """The harmonics ``first, first + stride, ...`` of the angle along the outline, so many terms."""

    first: int
    stride: int
    terms: int


@compiled
def harmonic_sums(
    grey: np.ndarray,
    table: np.ndarray,
    weights: np.ndarray,
    picture: tuple[np.ndarray, float],
    harmonics: Harmonics,
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
    harmonics : Harmonics
    limits : EdgeLimits

    Returns
    -------
    ndarray, shape (n, k, 3)
        0 where a fit cannot be repeated.
    """
    hole, reach = picture
    sums = np.zeros((len(table), harmonics.terms, 3))
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
        normal_equations(state, shading, pixels[:, :count], moments, expected, work)
        if not factorise(system, PARAMETERS, _SINGULAR):
            continue
        wanted = weights[number].copy()
        for axis in range(2):
            solve(system, wanted[axis])
        tests = _test_functions(state, pixels, _combined(wanted, slopes), harmonics)
        _write_sums(tests, (slopes, found[0]), (work[1], system), sums[number])
    return sums


@compiled
def _slopes(
    state: np.ndarray, shading: np.ndarray, band: tuple[np.ndarray, int], chunk: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return derivatives of the pixels by the parameters, (14, n), and residual and blurs away, (3, n)."""
    planes = chunk.reshape(PLANES, CHUNK)
    pixels, total = band
    slopes, found = np.zeros((PARAMETERS, pixels.shape[1])), np.empty((3, pixels.shape[1]))
    for first in range(0, total, CHUNK):
        count = min(CHUNK, total - first)
        planes[:ROWS, :count] = pixels[:, first : first + count]
        linearise(state, shading, chunk, count)
        slopes[:, first : first + count] = planes[ROWS : ROWS + PARAMETERS, :count]
        found[:, first : first + count] = planes[RESIDUAL : ALONG + 1, :count]
    for k in range(total, pixels.shape[1]):
        u, v = flattened(state, pixels[0, k], pixels[1, k])
        inside = u * u + v * v < 1.0
        side = 3 if inside else 0
        slopes[STATE + side, k], slopes[STATE + side + 1, k], slopes[STATE + side + 2, k] = 1.0, u, v
        found[0, k] = pixels[2, k] - shading[side] - shading[side + 1] * u - shading[side + 2] * v
        found[BLURS_AWAY - RESIDUAL, k] = -FAR if inside else FAR
    return slopes, found


@compiled
def _combined(weights: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """Return the weights of the pixels in the centre, (2, n), from those of the parameters."""
    combined = np.zeros((2, slopes.shape[1]))
    for axis in range(2):
        for i in range(PARAMETERS):
            weight, slope = weights[axis, i], slopes[i]
            for k in range(slopes.shape[1]):
                combined[axis, k] += weight * slope[k]
    return combined


@compiled
def _test_functions(
    state: np.ndarray, pixels: np.ndarray, weights: np.ndarray, harmonics: Harmonics
) -> np.ndarray:
    """Return the profile of the centre's weights times cosine and sine of each harmonic, (2 k, n)."""
    tests, total = np.empty((2 * harmonics.terms, pixels.shape[1])), 0.0
    for k in range(pixels.shape[1]):
        u, v = flattened(state, pixels[0, k], pixels[1, k])
        share = 1.0 / sqrt(u * u + v * v + TINY)
        cosine, sine = u * share, v * share
        wu = state[2] * weights[0, k] + state[3] * weights[1, k]
        wv = state[3] * weights[0, k] + state[4] * weights[1, k]
        profile = wu * cosine + wv * sine
        total += profile * profile
        turn, stride, wave = complex(cosine, sine), complex(1.0, 0.0), complex(profile, 0.0)
        for _ in range(harmonics.first):
            wave *= turn
        for _ in range(harmonics.stride):
            stride *= turn
        for j in range(harmonics.terms):
            tests[2 * j, k], tests[2 * j + 1, k] = wave.real, wave.imag
            wave *= stride
    return tests / sqrt(max(total, TINY))


@compiled
def _write_sums(
    tests: np.ndarray,
    band: tuple[np.ndarray, np.ndarray],
    fit: tuple[np.ndarray, np.ndarray],
    sums: np.ndarray,
) -> None:
    """Write one dot's sums.

    `band` holds derivatives and residuals, `fit` the priors' rows and the factorised system. A fit takes from
    a test function `t` what it can follow: of white noise ``t't - t'G inv(A) G't - |P inv(A) G't|^2`` is
    left, for derivatives G, priors P and A = G'G + P'P.
    """
    slopes, residual = band
    priors, system = fit
    both = np.empty((2, PARAMETERS))
    for harmonic in range(len(sums)):
        cosine, sine = tests[2 * harmonic], tests[2 * harmonic + 1]
        # Several sums at a time, so that none waits for the last.
        seen_c, seen_s, own = 0.0, 0.0, 0.0
        for k in range(len(residual)):
            seen_c += cosine[k] * residual[k]
            seen_s += sine[k] * residual[k]
            own += cosine[k] * cosine[k] + sine[k] * sine[k]
        for i in range(0, PARAMETERS, 2):
            p, q = slopes[i], slopes[i + 1]
            cosine_p, cosine_q, sine_p, sine_q = 0.0, 0.0, 0.0, 0.0
            for k in range(len(residual)):
                cosine_p += cosine[k] * p[k]
                cosine_q += cosine[k] * q[k]
                sine_p += sine[k] * p[k]
                sine_q += sine[k] * q[k]
            both[0, i], both[0, i + 1], both[1, i], both[1, i + 1] = cosine_p, cosine_q, sine_p, sine_q
        for followed in both:
            own -= _followed(followed, priors, system)
        sums[harmonic, 0], sums[harmonic, 1], sums[harmonic, 2] = seen_c, seen_s, max(own, 0.0)


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
