"""All corners of an AprilGrid that can be measured, from the tags that are read."""

from dataclasses import dataclass, replace

import numpy as np

from labcal.arrays import Pixels
from labcal.detect.corners.corner_fit import SettledCorner
from labcal.detect.corners.corners import Corners, Standard
from labcal.detect.corners.node_grid import NodeGrid, median_around
from labcal.detect.corners.roughest import roughest_clear
from labcal.detect.corners.tag_places import PlacedTags, next_tag
from labcal.detect.corners.tag_saddle import TagSaddle, fit_tag_saddle
from labcal.detect.corners.tag_wider_fits import wider_tag_fits
from labcal.detect.grey import GreyPicture
from labcal.detect.lattice.lattice import Node
from labcal.detect.stage_settings.corner import CornerSettings
from labcal.targets.april_grid import AprilGrid
from labcal.targets.april_grid_outlines import tag_cells

OFFSETS = ((0, 0), (1, 0), (1, 1), (0, 1))
"""Column and row of a tag's corners against its lower left one, anticlockwise."""
_ALONG, _ACROSS = (1, 0, 3, 2), (3, 2, 1, 0)
"""The next corner of the tag in the same row of corners, and in the same column, of each."""
_ROUGH_CORNERS = 3
"""Corners to either side whose residuals are the usual ones."""


def measured_tags(
    grey: GreyPicture, grid: AprilGrid, placed: PlacedTags, settings: CornerSettings
) -> Corners:
    """Fit the corners of the tags in place, and of those beside them that can be found.

    A tag that is not read is looked for where its neighbours predict it: each of its corners must be one,
    within a tenth of a tag.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    grid : AprilGrid
    placed : PlacedTags
        The tags that are read.
    settings : CornerSettings

    Returns
    -------
    Corners
        All of the tags that are read, without a fit where one is not measured; of the others those that are.
    """
    search = _Search.of(grey, grid, settings)
    first = {number: search.fits(number, quad) for number, quad in placed.corners.items()}
    standard = Standard.of([fit for four in first.values() for fit in four])
    first = {number: [standard.met_by(fit, settings) for fit in four] for number, four in first.items()}
    places = {number: _refined(quad, first[number]) for number, quad in placed.corners.items()}
    seen, tried = dict(placed.corners), set(placed.corners)
    while (expected := next_tag(replace(placed, corners=places), grid, tried)) is not None:
        number, quad = expected
        tried.add(number)
        side = float(np.linalg.norm(quad - np.roll(quad, 1, axis=0), axis=1).min())
        limit = settings.max_residual_squares * side
        four = [standard.met_by(fit, settings) for fit in search.fits(number, quad)]
        four = [
            fit if fit is not None and float(np.linalg.norm(fit.centre - q)) < limit else None
            for fit, q in zip(four, quad, strict=True)
        ]
        first[number], seen[number] = four, quad
        if all(fit is not None for fit in four):
            places[number] = _refined(quad, four)
    nodes = {
        _node(number, corner, grid): (number, corner, fit)
        for number, four in first.items()
        for corner, fit in enumerate(four)
        if fit is not None or number in placed.corners
    }
    fits = {node: fit for node, (_, _, fit) in nodes.items() if fit is not None}
    saddles = {
        node: search.saddle(number, _refined(seen[number], first[number]), corner)
        for node, (number, corner, fit) in nodes.items()
        if fit is not None
    }
    wide = wider_tag_fits(grey, fits, saddles, settings)
    standard = Standard.of(list(wide.values()))
    found = [standard.met_by(wide.get(node), settings) for node in nodes]
    corners = Corners(
        np.array(list(nodes), dtype=np.int64).reshape(-1, 2),
        np.array([_seen_at(fit, seen[number][corner]) for number, corner, fit in nodes.values()]).reshape(
            -1, 2
        ),
        found,
    )
    clear = _clear(corners, settings)
    kept = [ok or number in placed.corners for ok, (number, _, _) in zip(clear, nodes.values(), strict=True)]
    fits_of_clear = [fit if ok else None for fit, ok in zip(found, clear, strict=True)]
    return replace(corners, fits=fits_of_clear).select(np.flatnonzero(kept))


@dataclass(frozen=True)
class _Search:
    """The picture of a grid in which corners are looked for."""

    grey: GreyPicture
    gap: float
    border: float
    white: np.ndarray
    """White cells of every tag, by column and row from the lower left one, shape (tags, cells, cells)."""
    settings: CornerSettings

    @classmethod
    def of(cls, grey: GreyPicture, grid: AprilGrid, settings: CornerSettings) -> "_Search":
        """Return the search in a picture."""
        white = np.swapaxes(~tag_cells(grid)[:, ::-1], 1, 2)
        return cls(grey, grid.tag_spacing, grid.border_cells / white.shape[1], white, settings)

    def saddle(self, number: int, quad: Pixels, corner: int) -> TagSaddle:
        """Return what lies around a corner of a tag."""
        along, across = (quad[other[corner]] - quad[corner] for other in (_ALONG, _ACROSS))
        right, upper = OFFSETS[corner]
        return TagSaddle(
            centre=quad[corner],
            edges=np.stack([along, across], axis=1),
            gap=self.gap,
            border=self.border,
            opposite=quad[corner - 2] - quad[corner],
            white=np.ascontiguousarray(self.white[number][:: 1 - 2 * right, :: 1 - 2 * upper]),
        )

    def fits(self, number: int, quad: Pixels) -> list[SettledCorner | None]:
        """Return the fits of a tag's four corners."""
        return [
            fit_tag_saddle(self.grey, self.saddle(number, quad, k), self.settings) for k in range(len(quad))
        ]


def _node(number: int, corner: int, grid: AprilGrid) -> Node:
    """Return column and row of a corner of a tag."""
    row, col = divmod(number, grid.tag_cols)
    return 2 * col + OFFSETS[corner][0], 2 * row + OFFSETS[corner][1]


def _seen_at(fit: SettledCorner | None, place: np.ndarray) -> np.ndarray:
    """Return where a corner is, px: as fitted, or roughly."""
    return place if fit is None else fit.centre


def _refined(quad: Pixels, fits: list[SettledCorner | None]) -> Pixels:
    """Return a tag's corners, each as fitted where it is."""
    return np.array([_seen_at(fit, q) for q, fit in zip(quad, fits, strict=True)])


def _clear(corners: Corners, settings: CornerSettings) -> list[bool]:
    """Return which corners are not much rougher than those around: nothing lies over these.

    Edges without any blur leave residuals that depend on where they run between pixels.
    """
    roughness = np.array([np.nan if fit is None else fit.roughness for fit in corners.fits])
    sharp = [fit is not None and fit.state[4:6].min() <= settings.min_blur_px for fit in corners.fits]
    if not sharp:
        return []
    grid = NodeGrid(corners.index)
    usual = np.nan_to_num(median_around(grid.spread(roughness), _ROUGH_CORNERS)[grid.at])
    most = roughest_clear(usual, settings.clear_roughness_factor) + np.where(
        sharp, settings.roughness_share, 0.0
    )
    return [bool(ok) for ok in roughness <= most]
