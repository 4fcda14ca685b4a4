"""Gauss-Newton on dots, one after the other, in compiled code."""

from math import sqrt

import numpy as np

from labcal.detect.cholesky import factorise, solve
from labcal.detect.compiled import compiled
from labcal.detect.edges.band import pixels_around, without_clutter
from labcal.detect.edges.certainty import write_certainty
from labcal.detect.edges.edge_limits import EdgeLimits, PictureLimits
from labcal.detect.edges.edge_model import (
    CHUNK,
    MOMENTS,
    PARAMETERS,
    PLANES,
    PRIORS,
    SHADING,
    STATE,
    flat_moments,
    flattened,
    normal_equations,
)
from labcal.detect.edges.pixel_residuals import pixel_residuals
from labcal.detect.edges.residuals import (
    BURNT,
    CLIPPED,
    COVARIANCE,
    VARIANCE,
    ResidualLimits,
    add_scatter,
    clipped_sides,
    residual_statistics,
    slope_difference,
)
from labcal.detect.row_products import copy_columns

_DETERMINED = 3
"""Column, in the row below the system, of the number of parameters that the pixels determine."""
_SOME = 4
"""The first levels come from one of so many pixels."""
_SINGULAR = 1e-12


@compiled
def fit_all(
    grey: np.ndarray,
    table: np.ndarray,
    hole: np.ndarray,
    picture: PictureLimits,
    limits: tuple[EdgeLimits, ResidualLimits],
    room: tuple[np.ndarray, np.ndarray],
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Fit dot after dot, from the states in `table` and into its rows; return which converged, and pixels.

    The limits of the picture are the reach (radii), the grey values at which it is clipped, that of no light,
    the step between the dots whose residuals are added to the first array of `room`, and that between the
    dots whose pixels are kept. The second array, shape (n, CERTAINTY), receives the factorised systems, see
    :mod:`~labcal.detect.edges.certainty`. Pixels, float32, shape (3, m), and the places of each dot's among
    them, shape (n, 3), are as in :class:`~labcal.detect.edges.harmonics.KeptFits`.
    """
    edge, residual = limits
    sums, certainty = room
    ok = np.zeros(len(table), dtype=np.bool_)
    kept, places, taken = np.empty((3, 0), dtype=np.float32), np.zeros((len(table), 3), dtype=np.int64), 0
    system = np.empty((PARAMETERS + 2, PARAMETERS + 2))
    work = np.empty(PLANES * CHUNK), np.empty((PRIORS, PARAMETERS + 1)), system
    for number in range(len(table)):
        row, start = table[number], table[number].copy()
        radius = 1.0 / sqrt(start[2] * start[4] - start[3] * start[3])
        band, found = _fit_one(grey, row, (hole[number], picture.reach_radii), edge, work)
        pixels = band[0]
        moved = sqrt((row[0] - start[0]) ** 2 + (row[1] - start[1]) ** 2)
        if pixels.shape[1] == 0 or moved > edge.max_move_radii * radius:
            continue
        row[CLIPPED], clipped = clipped_sides(
            row, pixels, found, (picture.clipped_black, picture.clipped_white), residual
        )
        is_dot = int(abs(row[STATE + 3] - picture.black) > abs(row[STATE] - picture.black))
        row[BURNT] = clipped[is_dot] - clipped[1 - is_dot]
        if not residual_statistics(row, band, found, (system[PARAMETERS, _DETERMINED], clipped), residual):
            continue
        slope_difference(row, picture.black, system)
        for i in range(3):
            row[COVARIANCE + i] = row[VARIANCE] * system[PARAMETERS, i]
        write_certainty(work[1], system, certainty[number])
        ok[number] = True
        if number % picture.noise_every == 0:
            add_scatter(pixels, found, residual.flat_blurs, sums[number // picture.noise_every])
        if number % picture.outlines_every == 0:
            count = pixels.shape[1]
            if taken + count > kept.shape[1]:
                left = 1 + (len(table) - number) // picture.outlines_every
                larger = np.empty((3, taken + count * left + count * left // 4), dtype=np.float32)
                copy_columns(kept, 0, larger, (0, taken))
                kept = larger
            copy_columns(pixels, 0, kept, (taken, count))
            places[number, 0], places[number, 1], places[number, 2] = taken, band[1], count
            taken += count
    return ok, kept, places


@compiled
def _fit_one(
    grey: np.ndarray,
    row: np.ndarray,
    sizes: tuple[float, float],
    limits: EdgeLimits,
    work: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> tuple[tuple[np.ndarray, int], np.ndarray]:
    """Fit one dot, in place; return its band and its pixels' residuals, empty if it ran away."""
    state, shading = row[:STATE], row[STATE : STATE + SHADING]
    nothing = (np.empty((3, 0)), 0), np.empty((5, 0))
    band = nothing[0]
    for attempt in range(limits.max_bands):  # the band follows the blur once that is known
        made_for = state[5]
        band = pixels_around(grey, state, sizes, limits)
        if attempt == 0:
            _first_shading(state, band[0], shading)
        if not _settle(state, shading, band, limits, work):
            return nothing
        if max(made_for / state[5], state[5] / made_for) < limits.reband_factor:
            break
    found = pixel_residuals(state, shading, band, work[0])
    clean = without_clutter(band, found, abs(shading[0] - shading[3]), limits)
    if clean[0].shape[1] < band[0].shape[1]:
        if not _settle(state, shading, clean, limits, work):
            return nothing
        return clean, pixel_residuals(state, shading, clean, work[0])
    return band, found


@compiled
def _first_shading(state: np.ndarray, pixels: np.ndarray, shading: np.ndarray) -> None:
    """Write even levels of board and dot, the means on either side of the outline."""
    shading[:] = 0.0
    outside, inside = 0, 0
    for k in range(0, pixels.shape[1], _SOME):
        u, v = flattened(state, pixels[0, k], pixels[1, k])
        if u * u + v * v > 1.0:
            shading[0] += pixels[2, k]
            outside += 1
        else:
            shading[3] += pixels[2, k]
            inside += 1
    shading[0] /= max(outside, 1)
    shading[3] /= max(inside, 1)


@compiled
def _settle(
    state: np.ndarray,
    shading: np.ndarray,
    band: tuple[np.ndarray, int],
    limits: EdgeLimits,
    work: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> bool:
    """Iterate to the least squares, in place; False where it runs away.

    The row below the system is left with the result of :func:`_write_certainty`.
    """
    expected = limits.prior_shading_share, limits.prior_third_harmonic_per_px
    longest, blur_factor, least_blur = limits.max_step_radii, limits.max_blur_factor, limits.min_blur_px
    step, moments, system = np.empty(PARAMETERS), np.empty((2, MOMENTS)), work[2]
    pixels, count = band
    if pixels.shape[1] < 3 * PARAMETERS:
        return False
    edge = pixels[:, :count:2]  # half of it is enough for the first step
    flat_moments(state, shading, pixels[:, count:], work[0], moments)
    for number in range(limits.max_iterations):
        normal_equations(state, shading, edge, moments, expected, work)
        if not factorise(system, PARAMETERS, _SINGULAR):
            return False
        for i in range(PARAMETERS):
            step[i] = system[PARAMETERS, i]
        solve(system, step)
        a, b, c = state[2], state[3], state[4]
        radius = 1.0 / sqrt(a * c - b * b)
        # A step that leaves the region where the linearisation means anything is shortened.
        stretch = max(abs(step[2]), abs(step[3]), abs(step[4]))
        shift = sqrt(step[0] ** 2 + step[1] ** 2)
        short = 1.0 / max(shift / (longest * radius), stretch / longest, 1.0)
        if not short > 0.0:
            return False
        edge = pixels[:, :count]
        _reshape(state, step[2] * short, step[3] * short, step[4] * short)
        state[0] += step[0] * short
        state[1] += step[1] * short
        blur = max(state[5] + step[5], state[5] / blur_factor)
        state[5] = max(min(blur, blur_factor * state[5]), least_blur)
        state[6] += step[6]
        state[7] += step[7]
        for i in range(SHADING):
            shading[i] += step[STATE + i]
        if state[5] > radius:
            return False
        if (
            number > 0
            and shift < limits.shift_tolerance_px
            and stretch * radius < 2.0 * limits.shift_tolerance_px
            and (
                abs(step[5]) < limits.blur_tolerance_share * state[5]
                or (step[5] < 0.0 and state[5] == least_blur)
            )
        ):
            _write_certainty(step, work[1], system)
            return True
    return False


@compiled
def _write_certainty(step: np.ndarray, priors: np.ndarray, system: np.ndarray) -> None:
    """Write, below a factorised system, how far its solution is determined; `step` is overwritten.

    xx, xy and yy of the centre's covariance at unit noise, and the number of parameters that the pixels
    determine: priors determine the others.
    """
    for i in range(2):
        step[:] = 0.0
        step[i] = 1.0
        solve(system, step)
        system[PARAMETERS, 2 * i], system[PARAMETERS, 1] = step[i], step[1 - i]
    determined = float(PARAMETERS)
    for i in range(PRIORS):
        for j in range(PARAMETERS):
            step[j] = priors[i, j]
        solve(system, step)
        for j in range(PARAMETERS):
            determined -= priors[i, j] * step[j]
    system[PARAMETERS, _DETERMINED] = determined


@compiled
def _reshape(state: np.ndarray, xx: float, xy: float, yy: float) -> None:
    """Replace F by the symmetric matrix that maps to the unit circle what (1 + E) F maps there."""
    a, b, c = state[2], state[3], state[4]
    p, q = (1.0 + xx) * a + xy * b, (1.0 + xx) * b + xy * c
    r, s = xy * a + (1.0 + yy) * b, xy * b + (1.0 + yy) * c
    # The symmetric root of G'G, by Cayley and Hamilton.
    m, n, o = p * p + r * r, p * q + r * s, q * q + s * s
    root = abs(p * s - q * r)
    scale = 1.0 / sqrt(m + o + 2.0 * root)
    state[2], state[3], state[4] = (m + root) * scale, n * scale, (o + root) * scale
