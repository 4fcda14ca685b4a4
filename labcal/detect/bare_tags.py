"""Tags of an AprilGrid without small squares at their corners: read by outlines, fitted as wedges."""

import numpy as np

from labcal.arrays import Pixels
from labcal.detect.corners.corner_fit import SettledCorner
from labcal.detect.corners.corners import Corners, Standard
from labcal.detect.corners.tag_codes import SeenTags
from labcal.detect.corners.tag_places import cells_along
from labcal.detect.corners.tag_search import OFFSETS
from labcal.detect.grey import GreyPicture
from labcal.detect.marks.tag_corner import TagCorner, settled_tag_corner
from labcal.detect.marks.tags import recognised_tags
from labcal.detect.settings import DetectSettings
from labcal.detect.stage_settings.corner import CornerSettings
from labcal.targets.april_grid import AprilGrid

_ANTICLOCKWISE = np.array([1, 0, 3, 2])
"""OpenCV's corners, clockwise from the upper left one of its picture, half a turn from the print's."""
_WHITE_SHARE = 0.5
"""Reach of a fit into the white between tags, of its width."""


def read_bare_tags(grey: GreyPicture, grid: AprilGrid, settings: DetectSettings) -> SeenTags:
    """Return the tags of a grid's set that lie alone on white, as OpenCV reads them by their outlines.

    Its corners are off by a pixel or two; they are fitted where that is possible.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
    grid : AprilGrid
        Its set of tags and their border count alone.
    settings : DetectSettings
    """
    read = recognised_tags(grey, grid.dictionary, settings, grid.border_cells)
    numbers = np.array([number for number, _ in read], dtype=np.int64)
    quads = [_fitted(grey, grid, quad[_ANTICLOCKWISE], settings.corner) for _, quad in read]
    return SeenTags(numbers, np.array(quads).reshape(-1, 4, 2))


def _fitted(grey: GreyPicture, grid: AprilGrid, quad: Pixels, settings: CornerSettings) -> Pixels:
    """Return the corners of a tag, each as fitted where it is."""
    fits = _fits(grey, grid, quad, settings)
    return np.array([q if fit is None else fit.centre for q, fit in zip(quad, fits, strict=True)])


def _fits(
    grey: GreyPicture, grid: AprilGrid, quad: Pixels, settings: CornerSettings
) -> list[SettledCorner | None]:
    """Return the fits of a tag's four corners."""
    cells = cells_along(grid) / grid.border_cells
    quiet = _WHITE_SHARE * grid.tag_spacing * cells
    edges = np.stack([np.roll(quad, -1, axis=0) - quad, np.roll(quad, 1, axis=0) - quad], axis=2)
    corners = [TagCorner(q, along, cells, quiet) for q, along in zip(quad, edges, strict=True)]
    return [settled_tag_corner(grey, corner, settings) for corner in corners]


def has_corner_squares(grey: GreyPicture, grid: AprilGrid, placed: dict[int, Pixels]) -> bool | None:
    """Return whether it is black where small squares would touch most tags in place; None where none is seen.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
    grid : AprilGrid
    placed : dict of int to ndarray, shape (4, 2)
        Corners of tags, px, by number, anticlockwise.
    """
    border = 0.5 * grid.border_cells / cells_along(grid)
    black, white, square = [], [], []
    for quad in placed.values():
        inward = np.roll(quad, -2, axis=0) - quad
        edges = np.roll(quad, -1, axis=0) - quad
        outward = edges - inward  # from the end of an edge away from the tag
        black.append(_levels(grey, quad + border * inward))
        square.append(_levels(grey, quad - 0.5 * grid.tag_spacing * inward))
        white.append(_levels(grey, quad + 0.5 * edges + 0.5 * grid.tag_spacing * outward))
    levels = (np.nanmedian(np.concatenate(each)) for each in (black, white, square) if each)
    try:
        dark, light, between = (float(level) for level in levels)
    except ValueError:  # no tag
        return None
    return between < 0.5 * (dark + light) if np.isfinite(dark + light + between) else None


def _levels(grey: GreyPicture, places: Pixels) -> np.ndarray:
    """Return the levels of the nearest pixels, shape (n,); NaN beyond the frame."""
    x, y = np.rint(places).astype(int).T
    inside = (x >= 0) & (y >= 0) & (x < grey.shape[1]) & (y < grey.shape[0])
    levels = np.full(len(places), np.nan)
    levels[inside] = grey[y[inside], x[inside]]
    return levels


def bare_corners(
    grey: GreyPicture, grid: AprilGrid, placed: dict[int, Pixels], settings: CornerSettings
) -> Corners:
    """Fit the corners of the tags in place, each as a black wedge on white.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
    grid : AprilGrid
    placed : dict of int to ndarray, shape (4, 2)
        Corners of tags, px, by number, anticlockwise from the lower left one.
    settings : CornerSettings

    Returns
    -------
    Corners
        Without a fit where one is not measured.
    """
    index, seen_at, fits = [], [], list[SettledCorner | None]()
    for number, quad in placed.items():
        row, col = divmod(number, grid.tag_cols)
        index += [(2 * col + right, 2 * row + upper) for right, upper in OFFSETS]
        fits += _fits(grey, grid, quad, settings)
        seen_at.append(quad)
    standard = Standard.of(fits)
    fits = [standard.met_by(fit, settings) for fit in fits]
    places = np.concatenate(seen_at)
    seen = [q if fit is None else fit.centre for q, fit in zip(places, fits, strict=True)]
    return Corners(np.array(index, dtype=np.int64), np.array(seen), fits)
