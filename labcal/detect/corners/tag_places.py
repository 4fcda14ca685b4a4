"""The tags of an AprilGrid that are where the grid has them, and the places of others beside them."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float64, Int

from labcal.arrays import Pixels
from labcal.detect.corners.marker_agreement import (
    NEAREST,
    ids_seen_again,
    markers_that_agree,
    through_markers,
)
from labcal.detect.corners.seen_markers import SeenMarkers
from labcal.detect.corners.tag_codes import SeenTags
from labcal.detect.lattice.rough_undistortion import NONE, RoughUndistortion
from labcal.detect.stage_settings.corner import CornerSettings
from labcal.targets.april_grid import AprilGrid
from labcal.targets.charuco_opencv import opencv_dictionary


def cells_along(grid: AprilGrid) -> int:
    """Return the cells along a side of a tag, its border included."""
    return int(opencv_dictionary(grid.dictionary).markerSize) + 2 * grid.border_cells


def tag_corners(grid: AprilGrid) -> Float64[np.ndarray, "n 4 2"]:
    """Return the corners of every tag on the board, in tags, anticlockwise from the lower left one."""
    return corners_of_tags(grid, np.arange(grid.tag_count))


def corners_of_tags(grid: AprilGrid, number: Int[np.ndarray, " n"]) -> Float64[np.ndarray, "n 4 2"]:
    """Return the corners of some tags, as :func:`tag_corners`; and of rows beyond the grid."""
    row, col = np.divmod(number, grid.tag_cols)
    lower_left = (1.0 + grid.tag_spacing) * np.stack([col, row], axis=-1)
    return np.asarray(lower_left[:, None] + np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]))


@dataclass(frozen=True)
class PlacedTags:
    """Tags that are where the grid has them.

    Attributes
    ----------
    corners : dict of int to ndarray, shape (4, 2)
        By their number on the grid, px, anticlockwise from the lower left one.
    lens : RoughUndistortion
        The lens through which they agree.
    again : list of int
        Ids that are read at another place of the picture, too, where they agree as well.
    """

    corners: dict[int, Pixels]
    lens: RoughUndistortion = NONE
    again: list[int] = field(default_factory=list)

    def __len__(self) -> int:
        """Return how many they are."""
        return len(self.corners)

    def predicted(
        self, row: int, col: int, grid: AprilGrid, place: Float64[np.ndarray, "n 2"]
    ) -> Float64[np.ndarray, "n 2"]:
        """Return where places of the board (tags) are seen, px, by the tags nearest to a row and a column."""
        known = np.array(sorted(self.corners))
        away = np.maximum(np.abs(known // grid.tag_cols - row), np.abs(known % grid.tag_cols - col))
        near = known[np.argsort(away, kind="stable")[:NEAREST]]
        seen = np.array([self.corners[k] for k in near.tolist()])
        return through_markers(seen, tag_corners(grid)[near], place, self.lens)


def tags_in_place(
    seen: SeenTags,
    grid: AprilGrid,
    settings: CornerSettings,
    lenses: Sequence[RoughUndistortion] = (),
) -> PlacedTags:
    """Return the tags that agree with one another on the grid: their corners by their number on it.

    From one on, the next nearest one must be where its nearest neighbours in place predict it, through a wide
    lens in a roughly undistorted picture. The largest such set counts; it holds two tags or more, and at
    least half of those with ids of the grid.

    Parameters
    ----------
    seen : SeenTags
    grid : AprilGrid
    settings : CornerSettings
    lenses : sequence of RoughUndistortion
        Wide ones that are tried.
    """
    number = seen.number - grid.first_id
    own = np.flatnonzero((number >= 0) & (number < grid.tag_count))
    tags = SeenMarkers(number[own], seen.corners[own])
    on_board = tag_corners(grid)[tags.number]
    limit = settings.max_marker_residual_squares * grid.tag_spacing
    best = markers_that_agree(tags, on_board, limit, lenses)
    again = [number + grid.first_id for number in ids_seen_again(tags, on_board, limit, best)]
    return PlacedTags({int(tags.number[k]): tags.corners[k] for k in best.which}, best.lens, again)


def next_tag(placed: PlacedTags, grid: AprilGrid, tried: set[int]) -> tuple[int, Pixels] | None:
    """Return a tag next to those in place that was not tried, and where it should be; None if there is none.

    It is predicted by the homography of the nearest few, px.

    Parameters
    ----------
    placed : PlacedTags
    grid : AprilGrid
    tried : set of int
        The tags in place among them.
    """
    known = np.array(sorted(placed.corners))
    for number in range(grid.tag_count):
        if number in tried:
            continue
        row, col = divmod(number, grid.tag_cols)
        away = np.maximum(np.abs(known // grid.tag_cols - row), np.abs(known % grid.tag_cols - col))
        if away.min() > 1:
            continue
        return number, placed.predicted(row, col, grid, tag_corners(grid)[number])
    return None
