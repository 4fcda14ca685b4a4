"""Sub-pixel fit of one corner of a tag: a black wedge on white, with the tag's border and quiet zone."""

from dataclasses import dataclass

import numpy as np

from labcal.detect.corners.corner_fit import SettledCorner, is_cut, judge, settle
from labcal.detect.corners.corner_judgement import CornerFit
from labcal.detect.corners.corner_kernel import WEDGE
from labcal.detect.corners.corner_model import CornerPixels
from labcal.detect.corners.tag_window import TagWindow, first_state, normal_towards
from labcal.detect.grey import GreyPicture
from labcal.detect.stage_settings.corner import CornerSettings

_QUIET_CELLS = 0.8
"""Reach into the quiet zone around a tag, where that is a cell wide."""
_TO_MIDDLE = 0.5
"""Reach along an edge, of its length."""


@dataclass(frozen=True)
class TagCorner:
    """Surroundings of a corner of a tag.

    Attributes
    ----------
    centre : ndarray, shape (2,)
        Rough place of the corner, px.
    edges : ndarray, shape (2, 2)
        Columns: from the corner along its two edges to the next corners, px.
    cells : float
        Cells along an edge, the border included, which is one cell wide.
    quiet : float
        Reach into the quiet zone around a tag, in cells.
    """

    centre: np.ndarray
    edges: np.ndarray
    cells: float
    quiet: float = _QUIET_CELLS


def fit_tag_corner(grey: GreyPicture, corner: TagCorner, settings: CornerSettings) -> CornerFit | None:
    """Fit a corner as :func:`settled_tag_corner` does, with its uncertainty."""
    fit = settled_tag_corner(grey, corner, settings)
    return None if fit is None else judge(fit, settings)


def settled_tag_corner(
    grey: GreyPicture, corner: TagCorner, settings: CornerSettings
) -> SettledCorner | None:
    """Fit ``(1 + g d) (m + h W)`` to the pixels along the two edges of a corner, by Gauss-Newton.

    ``W`` is a black wedge on white that a Gaussian blurs, and the rest as for a chessboard
    (:func:`labcal.detect.corners.corner_fit.fit_corner`). Pixels reach to the middle of both edges, as far as
    a lens leaves them straight; the tag's own cells are left out.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    corner : TagCorner
        Where to begin.
    settings : CornerSettings

    Returns
    -------
    SettledCorner or None
        None where the fit does not converge within a cell of the beginning, or the frame is too near.
    """
    cell = np.linalg.norm(corner.edges, axis=0) / corner.cells
    narrow = float(
        abs(np.linalg.det(corner.edges)) / np.linalg.norm(corner.edges, axis=0).max() / corner.cells
    )
    state = _begin(grey, corner, settings)
    if state is None:
        return None
    for tolerance in (settings.first_tolerance_px, settings.tolerance_px):
        guard = settings.marker_guard_blurs * float(state[4:6].max()) / narrow
        window = _window(grey, corner, guard, settings)
        rms = settle(state, window, tolerance, settings)
        if rms < 0.0:
            return None
    if state[7] <= 0.0 or state[4:6].max() > narrow or float(np.hypot(*state[:2])) > cell.min():
        return None
    if is_cut(corner.centre + state[:2], grey, settings.frame_margin_px):
        return None
    return SettledCorner(state, window, corner.centre, rms / (2.0 * float(state[7])))


def _window(grey: GreyPicture, corner: TagCorner, guard: float, settings: CornerSettings) -> CornerPixels:
    """Select the pixels along the edges of a corner, with the border within and the quiet zone beyond."""
    longest = float(np.sqrt(settings.reach_bend_px * max(grey.shape)))
    reach = min(max(settings.min_reach_px, longest), float(np.linalg.norm(corner.edges, axis=0).max()))
    form, cells = TagWindow(corner.centre, corner.edges, reach, np.ones(2), WEDGE), corner.cells
    return form.pixels(
        grey,
        lambda nearest, farthest: (
            (cells * nearest > -corner.quiet) & (cells * nearest < 1.0 - guard) & (farthest < _TO_MIDDLE)
        ),
    )


def _begin(grey: GreyPicture, corner: TagCorner, settings: CornerSettings) -> np.ndarray | None:
    """Return first parameters; the normals point into the tag."""
    window = _window(grey, corner, 0.0, settings)
    if len(window.value) < settings.min_pixels:
        return None
    first, second = corner.edges.T
    normals = normal_towards(first, second), normal_towards(second, first)
    return first_state(window, normals, settings.first_blur_px)
