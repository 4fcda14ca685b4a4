"""Change of a picture by the places of the lines of a print, in compiled code."""

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.corners.printed_kernel import PrintLines
from labcal.detect.corners.printed_place import (
    LocalMap,
    blend_at,
    most_correlated,
    seen_place,
    unlit_place,
    widest_blurs,
)
from labcal.detect.corners.printed_profile import Axis, near_lines, quadrature, seen_lines, write_profile


@compiled
def line_derivatives(
    state: np.ndarray,
    offset: np.ndarray,
    place: tuple[LocalMap, PrintLines],
    kinds: tuple[np.ndarray, np.ndarray],
    out: np.ndarray,
) -> None:
    """Write derivatives of pixels' values by displacements of all lines of a kind, in squares.

    Parameters
    ----------
    state : ndarray, shape (PARAMETERS + 1,)
        Of the fit of a corner.
    offset : ndarray, shape (2, n)
        Of the pixels, px.
    place : (LocalMap, PrintLines)
    kinds : (ndarray of int, ndarray of int)
        Of the lines along x and along y: rows of `out`, or -1.
    out : ndarray, shape (p, n)
        Overwritten.
    """
    around, print_ = place
    x_kinds, y_kinds = kinds
    out[:] = 0.0
    nodes = quadrature(most_correlated(offset, around))
    across, down = np.empty((4, len(print_.x) + 1)), np.empty((4, len(print_.y) + 1))
    widest = widest_blurs(state, offset, around)
    nearest_x = np.searchsorted(print_.x, around.at[0])
    nearest_y = np.searchsorted(print_.y, around.at[1])
    rows, columns = np.empty(len(print_.x) + 1), np.empty(len(print_.y) + 1)
    for k in range(offset.shape[1]):
        x, y = offset[0, k] - state[0], offset[1, k] - state[1]
        place_x, place_y = unlit_place(around, x, y)
        near_x = near_lines(Axis(place_x, widest[0], 0.0), print_.x, nearest_x)
        near_y = near_lines(Axis(place_y, widest[1], 0.0), print_.y, nearest_y)
        near_x, near_y = seen_lines(near_x, near_y, print_.cells)
        many_x, many_y = near_x[1] - near_x[0], near_y[1] - near_y[0]
        if many_x == 0 and many_y == 0:
            continue
        seen = seen_place(state, around, (x, y), (place_x, place_y))
        single = many_x == 0 or many_y == 0
        along, sign, left = blend_at(seen.slopes)
        height = state[7] * (1.0 + state[8] * offset[0, k] + state[9] * offset[1, k])
        for node in range(1 if single else nodes.shape[1]):
            share = height * (1.0 if single else nodes[1, node])
            at = 0.0 if single else nodes[0, node]
            rest = 1.0 if single else left
            write_profile(seen.first, near_x, print_.x, (along * at, rest), across)
            write_profile(seen.second, near_y, print_.y, (sign * at, rest), down)
            rows[: many_x + 1], columns[: many_y + 1] = 0.0, 0.0
            for i in range(many_x + 1):
                for j in range(many_y + 1):
                    cell = print_.cells[near_x[0] + i, near_y[0] + j]
                    rows[i] += cell * down[0, j]
                    columns[j] += cell * across[0, i]
            for i in range(many_x):
                kind = x_kinds[near_x[0] + i]
                if kind >= 0:
                    out[kind, k] += share * across[3, i] * (rows[i] - rows[i + 1])
            for j in range(many_y):
                kind = y_kinds[near_y[0] + j]
                if kind >= 0:
                    out[kind, k] += share * down[3, j] * (columns[j] - columns[j + 1])
