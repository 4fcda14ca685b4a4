"""Sub-pixel fit of one corner of a tag of an AprilGrid, where a small black square touches the tag."""

from dataclasses import dataclass

import numpy as np

from labcal.detect.corners.corner_fit import SettledCorner, is_cut, settle
from labcal.detect.corners.corner_model import CornerPixels
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
    height, width = grey.shape
    longest = float(np.sqrt(settings.reach_bend_px * max(grey.shape)))
    reach = max(settings.min_reach_px, longest)
    low = np.maximum(np.ceil(corner.centre - reach), 0).astype(int)
    high = np.minimum(np.floor(corner.centre + reach), [width - 1, height - 1]).astype(int)
    if (high < low).any():
        return CornerPixels(np.zeros((0, 0), dtype=bool), np.zeros((2, 0)), np.zeros(0), _FAR)
    y, x = np.mgrid[low[1] : high[1] + 1, low[0] : high[0] + 1].astype(np.float64)
    offset = np.stack([x.ravel() - corner.centre[0], y.ravel() - corner.centre[1]])
    along = np.linalg.solve(corner.edges, offset)
    nearest, farthest = along.min(axis=0), along.max(axis=0)
    mask = (nearest > -_TO_MIDDLE * corner.gap) & (farthest < _TO_MIDDLE)
    mask &= (nearest < corner.border - guard) & (np.hypot(*offset) < reach)
    value = grey[low[1] : high[1] + 1, low[0] : high[0] + 1].astype(np.float64).ravel()[mask]
    return CornerPixels(mask.reshape(x.shape), offset[:, mask], value, _FAR)


def _begin(grey: GreyPicture, corner: TagSaddle, settings: CornerSettings) -> np.ndarray | None:
    """Return first parameters; one normal points into the tag, the other one out of it."""
    window = _window(grey, corner, 0.0, settings)
    if len(window.value) < settings.min_pixels:
        return None
    first, second = corner.edges.T
    into_first = np.array([-first[1], first[0]])
    into_first = into_first * np.sign(into_first @ second)
    out_of_second = np.array([-second[1], second[0]])
    out_of_second = -out_of_second * np.sign(out_of_second @ first)
    angles = [float(np.arctan2(one[1], one[0])) for one in (into_first, out_of_second)]
    black, white = np.percentile(window.value, [10, 90])
    blur = settings.first_blur_px
    return np.array(
        [0.0, 0.0, *angles, blur, blur, (black + white) / 2, (white - black) / 2, 0.0, 0.0], dtype=np.float64
    )
