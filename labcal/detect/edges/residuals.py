"""Statistics of the residuals of a converged fit: the outline, the noise, clipping, and the light."""

from math import pi, sqrt
from typing import NamedTuple

import numpy as np

from labcal.detect.cholesky import solve
from labcal.detect.compiled import compiled
from labcal.detect.edges.edge_model import FAR, PARAMETERS, SHADING, STATE, TINY, flattened
from labcal.detect.lane_sums import total, total_of_products

(
    COVARIANCE,
    DEPARTURE,
    VARIANCE,
    CLIPPED,
    SLOPE_DIFFERENCE,
    SLOPE_DIFFERENCE_COVARIANCE,
    BURNT,
    PROFILE,
    COLUMNS,
) = (
    14,
    17,
    18,
    19,
    20,
    22,
    29,
    30,
    31,
)
"""Columns of a fit: state, shading, xx xy yy of the centre's covariance, departure, variance of the noise,
how one-sidedly the board or the dot is clipped (0 to 1), the slope difference, see
:func:`slope_difference`, how much more of the brighter side is clipped than of the darker one, and by how
much of the step the edge is no error function."""
REACH = 2
"""Noise is looked at together over so many neighbouring pixels to either side."""
LAGS = (2 * REACH + 1) * (REACH + 1)
"""Rows down 0 to REACH, columns -REACH to REACH; row 0 holds every pair to the left twice."""
SUMS = 3
"""Of pairs of flat pixels, of products of their residuals, of products of gradients."""


class ResidualLimits(NamedTuple):
    """The settings of the edge fit for the statistics of residuals."""

    sectors: int
    max_arcs: int
    arc_px: float
    min_arcs: int
    profile_bin_blurs: float
    near_flat_blurs: float
    flat_blurs: float
    clipped_side_share: float
    clipped_chance_sigma: float


@compiled
def residual_statistics(
    row: np.ndarray,
    band: tuple[np.ndarray, int],
    found: np.ndarray,
    fit: tuple[float, tuple[float, float]],
    limits: ResidualLimits,
) -> bool:
    """Write departure and variance of the noise; False for too few pixels.

    `fit` holds the number of parameters that the pixels determine, and the clipped shares of board and dot.

    The departure is the root mean square distance (px) of the outline from the ellipse over sectors. What is
    the same at every sight of this dot (a print that is no circle, an edge that is no error function) is no
    noise: where arcs of the outline lie and the mean profile across it are taken out before the variance.
    """
    determined, clipped = fit
    pixels, count = band  # only the edge determines the outline
    state = row[:STATE]
    around = np.empty(count)
    for k in range(count):
        u, v = flattened(state, pixels[0, k], pixels[1, k])
        # Grows with the angle from 0 to 1 as the angle does, nearly evenly.
        quarter = u / (abs(u) + abs(v) + TINY)
        around[k] = 0.25 * (1.0 - quarter) if v >= 0.0 else 0.25 * (3.0 + quarter)
    noise, along = found[0].copy(), found[2]  # of all pixels
    moved, _ = _arcs(around, along, noise, limits.sectors)
    row[DEPARTURE] = sqrt((moved**2).mean())
    perimeter = 2.0 * pi / sqrt(state[2] * state[4] - state[3] * state[3])
    arcs = min(limits.max_arcs, int(perimeter / limits.arc_px))
    if arcs < limits.min_arcs:
        arcs = 0
    else:
        moved, place = _arcs(around, along, noise, arcs)
        for k in range(count):
            noise[k] -= along[k] * moved[place[k]]
    # The mean profile holds both levels and the blur, which the fit has estimated already.
    before = noise[:count].copy()
    profile = max(_take_out_profile(noise, count, found[1], limits.profile_bin_blurs) - 3, 0)
    for k in range(count):
        before[k] -= noise[k]
    row[PROFILE] = sqrt(total_of_products(before, before) / count) / max(
        abs(row[STATE] - row[STATE + 3]), TINY
    )
    freedom = len(noise) - determined - max(arcs - limits.min_arcs + 1, 0) - profile
    # Clipping cuts the noise off: such a side does not show how much of it the edge has.
    for k in range(count, len(noise)):
        if clipped[int(found[1, k] < 0.0)] > limits.clipped_side_share:
            noise[k] = 0.0
            freedom -= 1.0
    if freedom < PARAMETERS:
        return False
    row[VARIANCE] = total_of_products(noise, noise) / freedom
    return True


@compiled
def _arcs(
    around: np.ndarray, along: np.ndarray, residual: np.ndarray, arcs: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return how far each arc of the outline lies from the ellipse, px, and in which one each pixel lies."""
    place = np.empty(len(around), dtype=np.int32)
    for k in range(len(around)):
        place[k] = min(int(around[k] * arcs), arcs - 1)
    # Neighbours lie in one arc mostly: sums of even and of odd pixels do not wait for each other.
    weight, moved = np.zeros((2, arcs)), np.zeros((2, arcs))
    for k in range(len(around)):
        arc, half = place[k], k & 1
        weight[half, arc] += along[k] * along[k]
        moved[half, arc] += along[k] * residual[k]
    return (moved[0] + moved[1]) / np.maximum(weight[0] + weight[1], TINY), place


@compiled
def _take_out_profile(noise: np.ndarray, edge: int, blurs_away: np.ndarray, width: float) -> int:
    """Take the mean over each distance from the outline out of the residuals; return how many there are.

    Pixels behind those of the edge are flat: as far from it as any, on either side.
    """
    last, scale = int(2.0 * FAR / width), 1.0 / width
    sums, number = np.zeros(last + 1), np.zeros(last + 1)
    place = np.empty(edge, dtype=np.int32)
    for k in range(edge):
        place[k] = min(int((blurs_away[k] + FAR) * scale), last)
    for k in range(edge):
        sums[place[k]] += noise[k]
        number[place[k]] += 1.0
    flat, of_dot, inside = noise[edge:], blurs_away[edge:] < 0.0, 0
    of_either = np.empty((2, len(flat)))
    for k in range(len(flat)):
        of_either[0, k], of_either[1, k] = (flat[k], 0.0) if of_dot[k] else (0.0, flat[k])
        inside += of_dot[k]
    sums[0] += total(of_either[0])
    sums[last] += total(of_either[1])
    number[0] += inside
    number[last] += len(flat) - inside
    mean = sums / np.maximum(number, 1.0)
    for k in range(edge):
        noise[k] -= mean[place[k]]
    for k in range(len(flat)):
        flat[k] -= mean[0] if of_dot[k] else mean[last]
    return int((number > 0.0).sum())


@compiled
def clipped_sides(
    state: np.ndarray,
    pixels: np.ndarray,
    found: np.ndarray,
    clipped_at: tuple[float, float],
    limits: ResidualLimits,
) -> tuple[float, tuple[float, float]]:
    """Return how one-sidedly board or dot are clipped beside the edge, and how much of board and of dot is.

    An edge that is cut off all around keeps its centre; one that is cut off on one side does not.
    """
    if clipped_at[0] == -np.inf and clipped_at[1] == np.inf:
        return 0.0, (0.0, 0.0)
    sums, counts, cut_off = np.zeros((2, 2)), np.zeros(2), np.zeros(2)
    for k in range(pixels.shape[1]):
        if abs(found[1, k]) <= limits.near_flat_blurs:
            continue
        inside = int(found[1, k] < 0.0)
        counts[inside] += 1.0
        if (pixels[2, k] <= clipped_at[0]) if inside else (pixels[2, k] >= clipped_at[1]):
            u, v = flattened(state, pixels[0, k], pixels[1, k])
            share = 1.0 / max(sqrt(u * u + v * v), TINY)
            sums[inside, 0] += u * share
            sums[inside, 1] += v * share
            cut_off[inside] += 1.0
    counts, chance = np.maximum(counts, 1.0), limits.clipped_chance_sigma
    # What noise cuts off lies to all sides, as far as chance has it.
    board = (sqrt(sums[0, 0] ** 2 + sums[0, 1] ** 2) - chance * sqrt(cut_off[0])) / counts[0]
    dot = (sqrt(sums[1, 0] ** 2 + sums[1, 1] ** 2) - chance * sqrt(cut_off[1])) / counts[1]
    return max(board, dot), (cut_off[0] / counts[0], cut_off[1] / counts[1])


@compiled
def slope_difference(row: np.ndarray, black: float, system: np.ndarray) -> None:
    """Write how far dot and board are from being in one light, with its covariances, from a converged fit.

    In one light the slopes are as the levels above black. What is off that, of the step a radius, along the
    flattened x and y, is written to SLOPE_DIFFERENCE; to SLOPE_DIFFERENCE_COVARIANCE uu uv vv of its
    covariance, and xu xv yu yv of that with the centre.
    """
    shading = row[STATE : STATE + SHADING]
    board, dot = shading[0] - black, shading[3] - black
    scale = max(abs(board), abs(dot), TINY) * max(abs(shading[3] - shading[0]), TINY)
    board, dot = board / scale, dot / scale
    solved = np.zeros((2, PARAMETERS))
    for axis in range(2):
        row[SLOPE_DIFFERENCE + axis] = board * shading[4 + axis] - dot * shading[1 + axis]
        solved[axis, STATE + 1 + axis], solved[axis, STATE + 4 + axis] = -dot, board
        solve(system, solved[axis])
    for axis in range(2):
        along = -dot * solved[:, STATE + 1 + axis] + board * solved[:, STATE + 4 + axis]
        row[SLOPE_DIFFERENCE_COVARIANCE + 2 * axis] = row[VARIANCE] * along[axis]
        row[SLOPE_DIFFERENCE_COVARIANCE + 1] = row[VARIANCE] * along[1 - axis]
        for i in range(2):
            row[SLOPE_DIFFERENCE_COVARIANCE + 3 + 2 * i + axis] = row[VARIANCE] * solved[axis, i]


@compiled
def add_scatter(pixels: np.ndarray, found: np.ndarray, flat_blurs: float, sums: np.ndarray) -> None:
    """Add the products of one dot's residuals, by distance, to `sums`, shape (LAGS, SUMS).

    The edge itself is left out of the residuals, since what a print's outline does there is no noise.
    """
    left, top = int(pixels[0].min()) - REACH, int(pixels[1].min())
    width, height = int(pixels[0].max()) - left + 1 + REACH, int(pixels[1].max()) - top + 1 + REACH
    planes = np.zeros((4, height, width))  # flat or not, residual there, gradients along x and y
    for k in range(pixels.shape[1]):
        x, y = int(pixels[0, k]) - left, int(pixels[1, k]) - top
        planes[2, y, x], planes[3, y, x] = found[3, k], found[4, k]
        if abs(found[1, k]) > flat_blurs:
            planes[0, y, x], planes[1, y, x] = 1.0, found[0, k]
    for k in range(pixels.shape[1]):
        x, y = int(pixels[0, k]) - left, int(pixels[1, k]) - top
        flat, steep = planes[0, y, x] > 0.0, planes[2, y, x] != 0.0 or planes[3, y, x] != 0.0
        for down in range(REACH + 1):
            for across in range(-REACH, REACH + 1):
                lag = down * (2 * REACH + 1) + across + REACH
                i, j = y + down, x + across
                if flat:
                    sums[lag, 0] += planes[0, i, j]
                    sums[lag, 1] += planes[1, y, x] * planes[1, i, j]
                if steep:
                    sums[lag, 2] += planes[2, y, x] * planes[2, i, j] + planes[3, y, x] * planes[3, i, j]
