"""Sub-pixel fit of one corner of a tag of an AprilGrid, where a small black square touches the tag."""

from dataclasses import dataclass

import numpy as np

from labcal.detect.corners.corner_fit import SettledCorner, is_cut, settle
from labcal.detect.corners.corner_kernel import CHESSBOARD
from labcal.detect.corners.corner_model import CornerPixels
from labcal.detect.corners.tag_window import TagWindow, first_state, normal_towards
from labcal.detect.grey import GreyPicture
from labcal.detect.stage_settings.corner import CornerSettings

_FAR = np.full(2, 1e6)
"""Distance to markers in the white squares: there are none."""
_CELL_GUARD = 2.0
"""Distance kept from the tag's cells, in those kept from a marker whose border the model has."""
_TO_MIDDLE = 0.45
"""Reach along an edge, of the distance to the next corner on it."""


@dataclass(frozen=True)
class TagSaddle:
    """Surroundings of a corner.

    Attributes
    ----------
    centre : ndarray, shape (2,)
        Rough place of the corner, px.
    edges : ndarray, shape (2, 2)
        Columns: from the corner along the tag's two edges to its next corners, px.
    gap : float
        Side of the small square, in tags.
    border : float
        Width of the tag's black border, in tags.
    """

    centre: np.ndarray
    edges: np.ndarray
    gap: float
    border: float


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
    # The height of the strip that is plain on both sides of an edge, px.
    area, lengths = abs(float(np.linalg.det(corner.edges))), np.linalg.norm(corner.edges, axis=0)
    strip = min(corner.gap, corner.border)
    narrow = area / float(lengths.max())
    state = _begin(grey, corner, settings)
    if state is None or narrow <= 0.0:
        return None
    window = _window(grey, corner, 0.0, settings)
    for tolerance in (settings.first_tolerance_px, settings.tolerance_px):
        guard = _CELL_GUARD * settings.marker_guard_blurs * float(state[4:6].max()) / narrow
        window = _window(grey, corner, guard, settings)
        rms = settle(state, window, tolerance, settings)
        if rms < 0.0:
            return None
    if state[7] <= 0.0 or state[4:6].max() > strip * narrow:
        return None
    if float(np.hypot(*state[:2])) > strip * float(lengths.min()):
        return None
    if is_cut(corner.centre + state[:2], grey, settings.frame_margin_px):
        return None
    return SettledCorner(state, window, corner.centre, rms / (2.0 * float(state[7])))


def _window(grey: GreyPicture, corner: TagSaddle, guard: float, settings: CornerSettings) -> CornerPixels:
    """Select the pixels along the four edges that meet; `guard` is in tags."""
    longest = float(np.sqrt(settings.reach_bend_px * max(grey.shape)))
    form = TagWindow(corner.centre, corner.edges, max(settings.min_reach_px, longest), _FAR, CHESSBOARD)
    return form.pixels(
        grey,
        lambda nearest, farthest: (
            (nearest > -_TO_MIDDLE * corner.gap) & (farthest < _TO_MIDDLE) & (nearest < corner.border - guard)
        ),
    )


def _begin(grey: GreyPicture, corner: TagSaddle, settings: CornerSettings) -> np.ndarray | None:
    """Return first parameters; one normal points into the tag, the other one out of it."""
    window = _window(grey, corner, 0.0, settings)
    if len(window.value) < settings.min_pixels:
        return None
    first, second = corner.edges.T
    normals = normal_towards(first, second), -normal_towards(second, first)
    return first_state(window, normals, settings.first_blur_px)
