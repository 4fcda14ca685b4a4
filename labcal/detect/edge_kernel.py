"""Gauss-Newton on dots: a blurred step along an ellipse, its derivatives, and what its residuals tell.

A state is the centre (x, y), the entries xx, xy and yy of the symmetric matrix F that maps the outline to the
unit circle, the blur, and an egg's two numbers c and s: the flattened radius is ``1 + c cos 3a + s sin 3a``
at the angle a, which a bent picture makes of an ellipse and which leaves the centre of area where it is. The
parameters are, in this order, centre 2, ellipse 3 (the matrix E of the outline ``|(1 + E) F (q - c)| = 1``),
blur 1, egg 2, shading of the board 3 and of the dot 3 (level, slopes along the flattened x and y).
"""

from math import ceil, floor, pi, sqrt

import numpy as np

from labcal.detect.cholesky import factorise, solve
from labcal.detect.compiled import compiled

PARAMETERS, STATE, SHADING = 14, 8, 6
COVARIANCE, DEPARTURE, VARIANCE, CLIPPED, COLUMNS = 14, 17, 18, 19, 20
"""Columns of a fit: state, shading, xx xy yy of the centre's covariance, departure, variance of the noise,
and how one-sidedly the board or the dot is clipped (0 to 1)."""
_CHUNK = 192
"""Pixels that are linearised together, so few that they stay in the nearest cache."""
_ROWS, _RESIDUAL, _BLURS_AWAY, _ALONG, _PLANES = 3, 17, 18, 19, 20
"""Planes of a chunk: x, y, value, derivatives, residual, blurs from the edge, change with the distance."""
_ITERATIONS = 12
_BAND_BLURS, _BAND_PX = 3.5, 2.0
"""Half width of the fitted band."""
_HOLE_BLURS = 1.5
"""Blurs kept away from a ring's hole."""
_DOT_SHADING = 0.03
"""Prior standard deviation of the shading across a dot, of its step, a radius: a small dot tells no slope."""
_EGG = 1e-4
"""Prior standard deviation of an egg's numbers a px of radius: a small dot cannot tell one from a shift."""
_CLUTTER_SIGMAS, _CLUTTER_STEP, _CLUTTER_BLURS, _CLUTTER_PX = 5.0, 0.08, 2.0, 2.0
"""Clutter differs by so many standard deviations and so much of the step, so many blurs from the edge; it
takes its neighbours with it."""
_LEAST_BLUR = 0.2
"""px."""
_TOLERANCE = 4e-3
"""px: the last step, after which Gauss-Newton leaves less than a tenth of it."""
_OTHER_BLUR = 1.3
"""A band that was made for a blur so many times less or more is made anew."""
_SECTORS = 12
_MOST_ARCS, _SHORTEST_ARC, _FEWEST_ARCS = 24, 8.0, 8
"""Arcs of the outline whose places are no noise: so many, px long; fewer are the ellipse itself."""
_PROFILE_BIN = 0.5
"""Blurs."""
_TINY = 1e-30
_SINGULAR = 1e-12
REACH = 2
"""Noise is looked at together over so many neighbouring pixels to either side."""
LAGS = (2 * REACH + 1) * (REACH + 1)
"""Rows down 0 to REACH, columns -REACH to REACH; row 0 holds every pair to the left twice."""
SUMS = 3
"""Of pairs of flat pixels, of products of their residuals, of products of gradients."""
_FLAT = 2.5
"""Blurs from the edge: beyond is dot or board only."""


@compiled
def _linearise(state: np.ndarray, shading: np.ndarray, chunk: np.ndarray, count: int) -> None:
    """Write derivatives, residuals, distances and changes of a chunk's pixels into its planes.

    A pixel shows ``B + (D - B) Phi(-distance / blur)``. `chunk` is flat: planes at constant places let the
    compiler take four pixels at a time. Phi is good to seven digits (Abramowitz and Stegun 26.2.17).
    """
    cx, cy, a, b, c, sharp = state[0], state[1], state[2], state[3], state[4], 1.0 / state[5]
    egg_c, egg_s = state[6], state[7]
    b0, b1, b2, d0, d1, d2 = shading[0], shading[1], shading[2], shading[3], shading[4], shading[5]
    for k in range(count):
        dx, dy = chunk[k] - cx, chunk[_CHUNK + k] - cy
        u, v = a * dx + b * dy, b * dx + c * dy
        gx, gy = a * u + b * v, b * u + c * v
        share = 1.0 / sqrt(gx * gx + gy * gy + 1e-18)
        rho2 = u * u + v * v
        rho = sqrt(rho2)
        over = 1.0 / (rho2 * rho + 1e-18)
        cosine, sine = u * (u * u - 3.0 * v * v) * over, v * (3.0 * u * u - v * v) * over  # of 3 a
        t = (rho - 1.0 - egg_c * cosine - egg_s * sine) * rho * share * sharp
        t = min(max(t, -6.0), 6.0)
        # exp(-t^2 / 2), as the sixteenth power of a series that ends early.
        x = 0.03125 * t * t
        e = 1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 6.0 * (1.0 - x / 7.0 * (1.0 - x / 8.0))))
        e = 1.0 - x * (1.0 - x / 2.0 * (1.0 - x / 3.0 * e))
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
        chunk[3 * _CHUNK + k], chunk[4 * _CHUNK + k] = -pull * gx, -pull * gy
        chunk[5 * _CHUNK + k], chunk[6 * _CHUNK + k] = pull * u * u, 2.0 * pull * u * v
        chunk[7 * _CHUNK + k], chunk[8 * _CHUNK + k] = pull * v * v, -along * t
        egg = -pull * rho
        chunk[9 * _CHUNK + k], chunk[10 * _CHUNK + k] = egg * cosine, egg * sine
        chunk[11 * _CHUNK + k], chunk[12 * _CHUNK + k] = outside, outside * u
        chunk[13 * _CHUNK + k], chunk[14 * _CHUNK + k] = outside * v, inside
        chunk[15 * _CHUNK + k], chunk[16 * _CHUNK + k] = inside * u, inside * v
        chunk[17 * _CHUNK + k] = chunk[2 * _CHUNK + k] - outside * board - inside * dot
        chunk[18 * _CHUNK + k], chunk[19 * _CHUNK + k] = t, along


@compiled
def _normal_equations(
    state: np.ndarray, shading: np.ndarray, pixels: np.ndarray, chunk: np.ndarray, system: np.ndarray
) -> None:
    """Sum the normal equations over pixels into `system` (the last row the right side), with the prior."""
    system[:] = 0.0
    squares = 0.0
    planes = chunk.reshape(_PLANES, _CHUNK)
    total = pixels.shape[1]
    for first in range(0, total, _CHUNK):
        count = min(_CHUNK, total - first)
        planes[:_ROWS, :count] = pixels[:, first : first + count]
        _linearise(state, shading, chunk, count)
        _add_products(planes, count, system)
        for k in range(count):
            squares += planes[_RESIDUAL, k] * planes[_RESIDUAL, k]
    variance = squares / (total - PARAMETERS)
    believed = max(_DOT_SHADING * abs(shading[3] - shading[0]), _TINY)
    weight = variance / (believed * believed)
    for i in (12, 13):
        system[i, i] += weight
        system[PARAMETERS, i] -= weight * shading[i - STATE]
    # An egg grows with the radius as the picture bends under the dot.
    weight = variance * (state[2] * state[4] - state[3] * state[3]) / (_EGG * _EGG)
    for i in (6, 7):
        system[i, i] += weight
        system[PARAMETERS, i] -= weight * state[i]


@compiled
def _add_products(planes: np.ndarray, count: int, system: np.ndarray) -> None:
    """Add the scalar products of a chunk's derivatives, and with the residuals, to `system`, some too many.

    Four at a time, so that the loads are shared.
    """
    for i in range(PARAMETERS + 1):
        left = planes[_ROWS + i]
        for j in range(0, min(i + 1, PARAMETERS), 4):
            p, q, r, s = (
                planes[_ROWS + j],
                planes[_ROWS + j + 1],
                planes[_ROWS + j + 2],
                planes[_ROWS + j + 3],
            )
            total_p, total_q, total_r, total_s = 0.0, 0.0, 0.0, 0.0
            for k in range(count):
                value = left[k]
                total_p += value * p[k]
                total_q += value * q[k]
                total_r += value * r[k]
                total_s += value * s[k]
            system[i, j] += total_p
            system[i, j + 1] += total_q
            system[i, j + 2] += total_r
            system[i, j + 3] += total_s


@compiled
def _band(grey: np.ndarray, state: np.ndarray, hole: float, reach: float) -> np.ndarray:
    """Return x, y and value, shape (3, n), of the pixels near the outline, away from hole and other dots."""
    a, b, c = state[2], state[3], state[4]
    xx, yy, xy = a * a + b * b, b * b + c * c, b * (a + c)
    determinant = xx * yy - xy * xy
    extent_x, extent_y = sqrt(yy / determinant), sqrt(xx / determinant)
    width = _BAND_BLURS * state[5] + _BAND_PX
    half_x = min(extent_x * reach, extent_x + width) + 1.0
    half_y = min(extent_y * reach, extent_y + width) + 1.0
    height, columns = grey.shape
    left, right = max(floor(state[0] - half_x), 0), min(ceil(state[0] + half_x), columns - 1)
    top, bottom = max(floor(state[1] - half_y), 0), min(ceil(state[1] + half_y), height - 1)
    nearest = 0.0
    if hole > 0.0:
        nearest = min(hole + _HOLE_BLURS * state[5] / min(extent_x, extent_y), 0.5 * (1.0 + hole))
    # The distance changes with rho by no less than one over the largest slope, which bounds rho cheaply.
    steepest = 0.5 * (a + c) + sqrt(0.25 * (a - c) ** 2 + b * b)
    least = max(nearest, 1.0 - width * steepest, 0.0) ** 2
    most = min(reach, 1.0 + width * steepest) ** 2
    pixels = np.empty((3, max(bottom - top + 1, 0) * max(right - left + 1, 0)))
    count = 0
    for y in range(top, bottom + 1):
        dy = y - state[1]
        for x in range(left, right + 1):
            dx = x - state[0]
            u, v = a * dx + b * dy, b * dx + c * dy
            rho2 = u * u + v * v
            if rho2 < least or rho2 > most:
                continue
            gx, gy = a * u + b * v, b * u + c * v
            # |distance| < width, without the roots of first order's (rho - 1) rho / |g|.
            rho = sqrt(rho2)
            if (rho - 1.0) ** 2 * rho2 < width * width * (gx * gx + gy * gy):
                pixels[0, count], pixels[1, count], pixels[2, count] = x, y, grey[y, x]
                count += 1
    return pixels[:, :count].copy()


@compiled
def _first_shading(state: np.ndarray, pixels: np.ndarray, shading: np.ndarray) -> None:
    """Write even levels of board and dot, the means on either side of the outline."""
    shading[:] = 0.0
    outside, inside = 0, 0
    for k in range(pixels.shape[1]):
        dx, dy = pixels[0, k] - state[0], pixels[1, k] - state[1]
        u, v = state[2] * dx + state[3] * dy, state[3] * dx + state[4] * dy
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
    state: np.ndarray, shading: np.ndarray, pixels: np.ndarray, chunk: np.ndarray, system: np.ndarray
) -> bool:
    """Iterate to the least squares, in place; False where it runs away.

    `system` is left with xx, xy and yy of the centre's covariance at unit noise at the head of its last row.
    """
    step = np.empty(PARAMETERS)
    if pixels.shape[1] < 3 * PARAMETERS:
        return False
    for _ in range(_ITERATIONS):
        _normal_equations(state, shading, pixels, chunk, system)
        if not factorise(system, PARAMETERS, _SINGULAR):
            return False
        step[:] = system[PARAMETERS, :PARAMETERS]
        solve(system, step)
        a, b, c = state[2], state[3], state[4]
        radius = 1.0 / sqrt(a * c - b * b)
        # A step that leaves the region where the linearisation means anything is shortened.
        stretch = max(abs(step[2]), abs(step[3]), abs(step[4]))
        shift = sqrt(step[0] ** 2 + step[1] ** 2)
        short = 1.0 / max(shift / (0.2 * radius), stretch / 0.2, 1.0)
        if not short > 0.0:
            return False
        _reshape(state, step[2] * short, step[3] * short, step[4] * short)
        state[0] += step[0] * short
        state[1] += step[1] * short
        state[5] = max(min(max(state[5] + step[5], 0.5 * state[5]), 2.0 * state[5]), _LEAST_BLUR)
        state[6] += step[6]
        state[7] += step[7]
        for i in range(SHADING):
            shading[i] += step[STATE + i]
        if state[5] > radius:
            return False
        if shift < _TOLERANCE and stretch * radius < 10.0 * _TOLERANCE:
            for i in range(2):
                step[:] = 0.0
                step[i] = 1.0
                solve(system, step)
                system[PARAMETERS, 2 * i], system[PARAMETERS, 1] = step[i], step[1 - i]
            return True
    return False


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


@compiled
def _residuals(state: np.ndarray, shading: np.ndarray, pixels: np.ndarray, chunk: np.ndarray) -> np.ndarray:
    """Return residual, blurs from the edge, change with the distance, and the centre's gradients, (5, n)."""
    planes = chunk.reshape(_PLANES, _CHUNK)
    total = pixels.shape[1]
    found = np.empty((5, total))
    for first in range(0, total, _CHUNK):
        count = min(_CHUNK, total - first)
        planes[:_ROWS, :count] = pixels[:, first : first + count]
        _linearise(state, shading, chunk, count)
        found[:3, first : first + count] = planes[_RESIDUAL : _ALONG + 1, :count]
        found[3:, first : first + count] = planes[_ROWS : _ROWS + 2, :count]
    return found


@compiled
def _without_clutter(pixels: np.ndarray, found: np.ndarray, step: float) -> np.ndarray:
    """Leave out what is neither dot nor board: dirt, glare, other marks, all away from the edge."""
    size, away = np.abs(found[0]), np.abs(found[1]) > _CLUTTER_BLURS
    if not ((size > _CLUTTER_STEP * step) & away).any():
        return pixels
    odd = (size > max(_CLUTTER_SIGMAS * 1.4826 * np.median(size), _CLUTTER_STEP * step)) & away
    keep = np.ones(len(size), dtype=np.bool_)
    for j in np.flatnonzero(odd):
        near = np.maximum(np.abs(pixels[0] - pixels[0, j]), np.abs(pixels[1] - pixels[1, j]))
        keep &= ~((near <= _CLUTTER_PX) & away)
    return pixels[:, keep]


@compiled
def _judge(row: np.ndarray, pixels: np.ndarray, found: np.ndarray) -> bool:
    """Write departure and variance of the noise; False for too few pixels.

    The departure is the root mean square distance (px) of the outline from the ellipse over sectors. What is
    the same at every sight of this dot (a print that is no circle, an edge that is no error function) is no
    noise: where arcs of the outline lie and the mean profile across it are taken out before the variance.
    """
    state, count = row[:STATE], pixels.shape[1]
    around = np.empty(count)
    for k in range(count):
        dx, dy = pixels[0, k] - state[0], pixels[1, k] - state[1]
        u, v = state[2] * dx + state[3] * dy, state[3] * dx + state[4] * dy
        # Grows with the angle from 0 to 1 as the angle does, nearly evenly.
        quarter = u / (abs(u) + abs(v) + _TINY)
        around[k] = 0.25 * (1.0 - quarter) if v >= 0.0 else 0.25 * (3.0 + quarter)
    noise, along = found[0].copy(), found[2]
    moved = _arcs(around, along, noise, _SECTORS)
    row[DEPARTURE] = sqrt((moved**2).mean())
    perimeter = 2.0 * pi / sqrt(state[2] * state[4] - state[3] * state[3])
    arcs = min(_MOST_ARCS, int(perimeter / _SHORTEST_ARC))
    if arcs < _FEWEST_ARCS:
        arcs = 0
    else:
        moved = _arcs(around, along, noise, arcs)
        for k in range(count):
            noise[k] -= along[k] * moved[int(around[k] * arcs) % arcs]
    freedom = count - PARAMETERS - max(arcs - _FEWEST_ARCS + 1, 0) - _take_out_profile(noise, found[1])
    if freedom < PARAMETERS:
        return False
    row[VARIANCE] = (noise * noise).sum() / freedom
    return True


@compiled
def _arcs(around: np.ndarray, along: np.ndarray, residual: np.ndarray, arcs: int) -> np.ndarray:
    """Return how far each arc of the outline lies from the ellipse, px."""
    weight, moved = np.zeros(arcs), np.zeros(arcs)
    for k in range(len(around)):
        arc = int(around[k] * arcs) % arcs
        weight[arc] += along[k] * along[k]
        moved[arc] += along[k] * residual[k]
    return moved / np.maximum(weight, _TINY)


@compiled
def _take_out_profile(noise: np.ndarray, blurs_away: np.ndarray) -> int:
    """Take the mean over each distance from the outline out of the residuals; return how many there are."""
    count = int(12.0 / _PROFILE_BIN) + 1
    total, number = np.zeros(count), np.zeros(count)
    for k in range(len(noise)):
        here = int((blurs_away[k] + 6.0) / _PROFILE_BIN)
        total[here] += noise[k]
        number[here] += 1.0
    mean = total / np.maximum(number, 1.0)
    for k in range(len(noise)):
        noise[k] -= mean[int((blurs_away[k] + 6.0) / _PROFILE_BIN)]
    return int((number > 0.0).sum())


@compiled
def _clipped(state: np.ndarray, pixels: np.ndarray, found: np.ndarray, low: float, high: float) -> float:
    """Return how one-sidedly the board beside the edge, or the dot, is clipped: 0 not at all, at most 1.

    An edge that is cut off all around keeps its centre; one that is cut off on one side does not.
    """
    sums, counts, cut_off = np.zeros((2, 2)), np.zeros(2), np.zeros(2)
    for k in range(pixels.shape[1]):
        if abs(found[1, k]) <= _CLUTTER_BLURS:
            continue
        inside = int(found[1, k] < 0.0)
        counts[inside] += 1.0
        if (pixels[2, k] <= low) if inside else (pixels[2, k] >= high):
            dx, dy = pixels[0, k] - state[0], pixels[1, k] - state[1]
            u, v = state[2] * dx + state[3] * dy, state[3] * dx + state[4] * dy
            share = 1.0 / max(sqrt(u * u + v * v), _TINY)
            sums[inside, 0] += u * share
            sums[inside, 1] += v * share
            cut_off[inside] += 1.0
    # What noise cuts off lies to all sides, as far as chance has it.
    board = (sqrt(sums[0, 0] ** 2 + sums[0, 1] ** 2) - 2.0 * sqrt(cut_off[0])) / max(counts[0], 1.0)
    dot = (sqrt(sums[1, 0] ** 2 + sums[1, 1] ** 2) - 2.0 * sqrt(cut_off[1])) / max(counts[1], 1.0)
    one_sided: float = max(board, dot)
    return one_sided


@compiled
def _add_scatter(pixels: np.ndarray, found: np.ndarray, sums: np.ndarray) -> None:
    """Add what one dot's residuals tell of the noise to `sums`, shape (LAGS, SUMS).

    The edge itself is left out of the residuals, since what a print's outline does there is no noise.
    """
    left, top = int(pixels[0].min()) - REACH, int(pixels[1].min())
    width, height = int(pixels[0].max()) - left + 1 + REACH, int(pixels[1].max()) - top + 1 + REACH
    planes = np.zeros((4, height, width))  # flat or not, residual there, gradients along x and y
    for k in range(pixels.shape[1]):
        x, y = int(pixels[0, k]) - left, int(pixels[1, k]) - top
        planes[2, y, x], planes[3, y, x] = found[3, k], found[4, k]
        if abs(found[1, k]) > _FLAT:
            planes[0, y, x], planes[1, y, x] = 1.0, found[0, k]
    for k in range(pixels.shape[1]):
        x, y = int(pixels[0, k]) - left, int(pixels[1, k]) - top
        for down in range(REACH + 1):
            for across in range(-REACH, REACH + 1):
                lag = down * (2 * REACH + 1) + across + REACH
                i, j = y + down, x + across
                sums[lag, 0] += planes[0, y, x] * planes[0, i, j]
                sums[lag, 1] += planes[1, y, x] * planes[1, i, j]
                sums[lag, 2] += planes[2, y, x] * planes[2, i, j] + planes[3, y, x] * planes[3, i, j]


@compiled
def fit_all(
    grey: np.ndarray,
    table: np.ndarray,
    hole: np.ndarray,
    limits: tuple[float, float, float],
    every: int,
    sums: np.ndarray,
) -> np.ndarray:
    """Fit dot after dot, from the states in `table` and into its rows; return which settled.

    The limits are the reach (radii), and the grey values at which the picture is clipped. Into `sums` goes
    what every so-manieth dot tells of the noise.
    """
    ok = np.zeros(len(table), dtype=np.bool_)
    chunk, system = np.empty(_PLANES * _CHUNK), np.empty((PARAMETERS + 1, PARAMETERS + 2))
    for number in range(len(table)):
        row, start = table[number], table[number].copy()
        radius = 1.0 / sqrt(start[2] * start[4] - start[3] * start[3])
        pixels, found = _fit_one(grey, row, (hole[number], limits[0]), chunk, system)
        moved = sqrt((row[0] - start[0]) ** 2 + (row[1] - start[1]) ** 2)
        if pixels.shape[1] == 0 or moved > 0.5 * radius or not _judge(row, pixels, found):
            continue
        for i in range(3):
            row[COVARIANCE + i] = row[VARIANCE] * system[PARAMETERS, i]
        row[CLIPPED] = _clipped(row, pixels, found, limits[1], limits[2])
        ok[number] = True
        if number % every == 0:
            _add_scatter(pixels, found, sums)
    return ok


@compiled
def _fit_one(
    grey: np.ndarray, row: np.ndarray, limits: tuple[float, float], chunk: np.ndarray, system: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Fit one dot, in place; return its pixels and what :func:`_residuals` tells, none where it ran away."""
    state, shading = row[:STATE], row[STATE : STATE + SHADING]
    nothing = np.empty((3, 0))
    pixels = nothing
    for attempt in range(3):  # the band follows the blur once that is known
        made_for = state[5]
        pixels = _band(grey, state, limits[0], limits[1])
        if attempt == 0:
            _first_shading(state, pixels, shading)
        if not _settle(state, shading, pixels, chunk, system):
            return nothing, nothing
        if max(made_for / state[5], state[5] / made_for) < _OTHER_BLUR:
            break
    found = _residuals(state, shading, pixels, chunk)
    clean = _without_clutter(pixels, found, abs(shading[0] - shading[3]))
    if clean.shape[1] < pixels.shape[1]:
        if not _settle(state, shading, clean, chunk, system):
            return nothing, nothing
        return clean, _residuals(state, shading, clean, chunk)
    return pixels, found
