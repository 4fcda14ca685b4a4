"""Sub-pixel fits of one corner of a tag of an AprilGrid, where a small black square touches the tag."""

from dataclasses import dataclass
from math import atan2, hypot
from typing import NamedTuple

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.corners.corner_fit import SettledCorner, settle
from labcal.detect.corners.corner_kernel import CHESSBOARD, PARAMETERS, FitLimits, settled
from labcal.detect.corners.corner_model import CornerPixels
from labcal.detect.corners.corner_window import near_edges
from labcal.detect.corners.first_state import write_first_state
from labcal.detect.corners.tag_cell_light import cell_light
from labcal.detect.corners.tag_pixels import TagForm, tag_heights, tag_pixels
from labcal.detect.grey import GreyPicture
from labcal.detect.stage_settings.corner import CornerSettings

_FAR = np.full(2, 1e6)
"""Distance to markers in the white squares: there are none."""
_CELL_GUARD, _LEAST_STRIP = 3.0, 1.5
"""Distance kept from the tag's cells, whose light is subtracted, and the least strip used; in blurs."""
_TO_MIDDLE, _WIDE_TO_MIDDLE = 0.48, 0.5
"""Reach along an edge, of the distance to the next corner on it: of the first fit, of the second one."""
_LEAST_REACH_PX = 8.0
"""Of a first fit: with less, a small tag has too few pixels. The second one knows how the edges bend."""


class _FirstLimits(NamedTuple):
    """The settings of corners that a first fit takes, besides those of Gauss-Newton."""

    first_blur_px: float
    first_tolerance_px: float
    tolerance_px: float
    marker_guard_blurs: float
    min_pixels: int
    frame_margin_px: float


@dataclass(frozen=True)
class TagSaddle:
    """Surroundings of a corner.

    Attributes
    ----------
    centre : ndarray, shape (2,)
        Rough place of the corner, px.
    edges : ndarray, shape (2, 2)
        Columns: from the corner along the tag's two edges to its next corners, px: along its row, then up or
        down.
    gap : float
        Side of the small square, in tags.
    border : float
        Width of the tag's black border, in tags.
    opposite : ndarray, shape (2,)
        From the corner to the opposite one of the tag, px.
    white : ndarray of bool, shape (cells, cells)
        Which cells of the tag are white, along the first edge from the corner on, and along the second one.
    """

    centre: np.ndarray
    edges: np.ndarray
    gap: float
    border: float
    opposite: np.ndarray
    white: np.ndarray


def fit_tag_saddle(grey: GreyPicture, corner: TagSaddle, settings: CornerSettings) -> SettledCorner | None:
    """Fit a chessboard's corner to a tag's border, the small square and the white beside them.

    The model is that of :func:`labcal.detect.corners.corner_fit.fit_corner`. Pixels reach nearly to the
    middles of the four edges that meet, as far as a lens leaves them straight; the tag's cells, what lies
    across the white space, and the blur of both are left out.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    corner : TagSaddle
        Where to begin.
    settings : CornerSettings

    Returns
    -------
    SettledCorner or None
        None where the fit does not converge near the beginning, or the frame is too near.
    """
    longest = float(np.sqrt(settings.reach_bend_px * max(grey.shape)))
    form = TagForm(
        corner.gap, corner.border, _TO_MIDDLE, max(settings.min_reach_px, longest, _LEAST_REACH_PX)
    )
    place = np.ascontiguousarray(corner.centre), np.ascontiguousarray(corner.edges)
    limits = settings.limits(_FirstLimits), settings.limits(FitLimits)
    ok, state, (mask, offset, value), rms = _first_fit(
        grey, (*place, corner.opposite, corner.white), form, limits
    )
    if not ok:
        return None
    window = CornerPixels(mask, offset, value, _FAR, CHESSBOARD)
    return SettledCorner(state, window, corner.centre, rms / (2.0 * float(state[7])))


@compiled
def _first_fit(
    grey: np.ndarray,
    tag: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray],
    form: TagForm,
    limits: tuple[_FirstLimits, FitLimits],
) -> tuple[bool, np.ndarray, tuple[np.ndarray, np.ndarray, np.ndarray], float]:
    """Return whether a fit converges near its beginning; its state, window and root mean square residual.

    `tag` holds the corner's centre, the tag's edges, the way to its opposite corner and its white cells.
    """
    centre, edges, opposite, white = tag
    place = (centre, edges)
    own, newton = limits
    state, straight, far = np.zeros(PARAMETERS), np.zeros(2), np.full(2, 1e6)
    window = tag_pixels(grey, place, form, 0.0)
    if len(window[2]) < own.min_pixels:
        return False, state, window, 0.0
    _begin(state, window[2], edges, own.first_blur_px)
    rms = -1.0
    for tolerance in (own.first_tolerance_px, own.tolerance_px):
        # What is left out beside the cells, and their light, follow the blur, once it is known.
        window = _darkened(grey, place, (form, own.marker_guard_blurs), (edges, opposite, white), state)
        if len(window[2]) < own.min_pixels:
            return False, state, window, 0.0
        pixels = (window[1], window[2], far, straight, CHESSBOARD, 0.0)
        rms = settled(state, pixels, (tolerance, PARAMETERS), newton)
        if rms < 0.0:
            return False, state, window, 0.0
    first, second = tag_heights(edges)
    strip = min(form.gap, form.border)
    shortest = min(hypot(edges[0, 0], edges[1, 0]), hypot(edges[0, 1], edges[1, 1]))
    x, y, margin = centre[0] + state[0], centre[1] + state[1], own.frame_margin_px
    ok = (
        state[7] > 0.0
        and max(state[4], state[5]) <= strip * min(first, second)
        and hypot(state[0], state[1]) <= strip * shortest
        and min(x, y) >= margin
        and x <= grey.shape[1] - 1 - margin
        and y <= grey.shape[0] - 1 - margin
    )
    return ok, state, window, rms


@compiled
def _darkened(
    grey: np.ndarray,
    place: tuple[np.ndarray, np.ndarray],
    form: tuple[TagForm, float],
    tag: tuple[np.ndarray, np.ndarray, np.ndarray],
    state: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return mask, offsets and values of pixels, less the light of the tag's white cells, by a state.

    `form` holds the share of the guard, too; `tag` what :func:`cell_light` takes.
    """
    heights = tag_heights(tag[0])
    blur = max(state[4], state[5])
    plain = form[0].border * min(heights[0], heights[1]) - _LEAST_STRIP * blur
    guard = max(min(_CELL_GUARD * blur, plain), blur) * form[1]
    mask, offset, value = tag_pixels(grey, place, form[0], guard)
    spread = cell_light(offset, tag, (state[4] / heights[0], state[5] / heights[1]))
    for k in range(len(value)):
        light = 1.0 + state[8] * offset[0, k] + state[9] * offset[1, k]
        value[k] -= 2.0 * state[7] * light * spread[k]
    return mask, offset, value


@compiled
def _begin(state: np.ndarray, value: np.ndarray, edges: np.ndarray, blur: float) -> None:
    """Write first parameters.

    The normal of the edge across the row points into the tag, that of the edge along the row out of it: the
    step from black to white is then positive.
    """
    ax, ay, bx, by = edges[0, 0], edges[1, 0], edges[0, 1], edges[1, 1]
    inward = 1.0 if bx * ay - by * ax > 0.0 else -1.0
    outward = -1.0 if ay * bx - ax * by > 0.0 else 1.0
    normals = atan2(inward * bx, -inward * by), atan2(-outward * ax, outward * ay)
    write_first_state(state, normals, value, blur)


def widened_tag_saddle(
    grey: GreyPicture, corner: TagSaddle, bend: np.ndarray, first: np.ndarray, settings: CornerSettings
) -> SettledCorner | None:
    """Fit the same to all pixels along the edges, from the state of a first fit on.

    What light the tag's white cells spread into its border is subtracted.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    corner : TagSaddle
        With the corner of the first fit as its centre.
    bend : ndarray, shape (2,)
        Curvature of either edge towards its normal, 1/px: across the row, along it.
    first : ndarray, shape (PARAMETERS,)
        The first fit's state.
    settings : CornerSettings

    Returns
    -------
    SettledCorner or None
        None where the fit leaves the first one by more than either may be off.
    """
    state = first.copy()
    state[:2] = 0.0
    blur = max(float(first[4]), float(first[5]))
    form = TagForm(corner.gap, corner.border, _WIDE_TO_MIDDLE, settings.max_reach_px)
    place = np.ascontiguousarray(corner.centre), np.ascontiguousarray(corner.edges)
    tag = (place[1], corner.opposite, corner.white)
    pixels = _darkened(grey, place, (form, settings.marker_guard_blurs), tag, state)
    mask, offset, value = near_edges(pixels, state, settings.edge_blurs)
    window = CornerPixels(mask, offset, value, _FAR, CHESSBOARD, bend)
    rms = settle(state, window, settings.first_tolerance_px, settings)
    if rms < 0.0 or state[7] <= 0.0:
        return None
    if state[4:6].max() > min(corner.gap, corner.border) * min(tag_heights(place[1])):
        return None
    if float(np.hypot(*state[:2])) > settings.max_refit_blurs * blur:
        return None
    return SettledCorner(state, window, corner.centre, rms / (2.0 * float(state[7])))
