"""The reason why no tags of a picture place an AprilGrid: another border, set or grid, or other ids."""

from collections.abc import Iterator

from labcal.detect.bare_tags import has_corner_squares, read_bare_tags
from labcal.detect.corners.markers_elsewhere import ids_read
from labcal.detect.corners.reduced import reduced_pictures
from labcal.detect.corners.saddle_angles import unturned
from labcal.detect.corners.saddles import find_saddles
from labcal.detect.corners.tag_codes import SeenTags, read_tags
from labcal.detect.corners.tag_places import PlacedTags, tags_in_place
from labcal.detect.flags import Refusal
from labcal.detect.grey import GreyPicture
from labcal.detect.lattice.rough_undistortion import fisheyes_of
from labcal.detect.settings import DetectSettings
from labcal.targets.april_grid import AprilGrid
from labcal.targets.charuco import MarkerDictionary
from labcal.wording import counted

_HAS_NONE = "Tags of the target are in place, but no small black squares touch their corners."
_STRAY = 2
"""Tags that are read by chance among the many squares of a picture, of another print."""
_ENOUGH = 3
"""Tags in place, or all of a smaller grid, that tell that the print is one of another border or set."""
_BORDERS = (1, 2)
_FAMILIES = (
    MarkerDictionary.DICT_APRILTAG_36H11,
    MarkerDictionary.DICT_APRILTAG_25H9,
    MarkerDictionary.DICT_APRILTAG_16H5,
    MarkerDictionary.DICT_APRILTAG_36H10,
)
"""Sets of tags that are tried, the usual ones first."""


def why_no_tags(
    grey: GreyPicture, seen: SeenTags, grid: AprilGrid, settings: DetectSettings
) -> tuple[Refusal, str]:
    """Return why no tags place a grid, and a sentence on those that are read.

    Where hardly any are read, tags with another border and of other sets are looked for.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
    seen : SeenTags
        Those of the grid's set that are read.
    grid : AprilGrid
    settings : DetectSettings
    """
    if grid.corner_squares:
        bare = _placed(read_bare_tags(grey, grid, settings), grey, grid, settings)
        if has_corner_squares(grey, grid, bare.corners) is False:
            return Refusal.CORNER_SQUARES, _HAS_NONE
    numbers = set(seen.number.tolist())
    other = _other_print(grey, grid, settings) if len(numbers) <= _STRAY else None
    if other is not None:
        return other
    if not numbers:
        return Refusal.NO_MARKERS, ""
    last = grid.first_id + grid.tag_count - 1
    own, detail = sum(grid.first_id <= number <= last for number in numbers), ids_of_tags(seen, grid)
    if own == 0 and len(numbers) == 1:
        return Refusal.NO_MARKERS, f"{detail} One tag alone may be read by chance."
    if own <= len(numbers) - own:
        return Refusal.OTHER_IDS, detail
    return (Refusal.MARKERS_UNREADABLE if own == 1 else Refusal.OTHER_BOARD), detail


def ids_of_tags(seen: SeenTags, grid: AprilGrid) -> str:
    """Return a sentence on the tags that are read, and those of the grid."""
    last = grid.first_id + grid.tag_count - 1
    return ids_read("Tag", sorted(set(seen.number.tolist())), str(grid.dictionary), (grid.first_id, last))


def _placed(seen: SeenTags, grey: GreyPicture, grid: AprilGrid, settings: DetectSettings) -> PlacedTags:
    """Return the tags in place, also through wide lenses."""
    return tags_in_place(seen, grid, settings.corner, fisheyes_of(grey, settings.grid))


def _other_print(grey: GreyPicture, grid: AprilGrid, settings: DetectSettings) -> tuple[Refusal, str] | None:
    """Return a refusal that names the border and the set of the tags in the grid's places, if any are."""
    sets = [grid.dictionary, *(one for one in _FAMILIES if one != grid.dictionary)]
    others = [
        grid.model_copy(update={"dictionary": dictionary, "border_cells": border})
        for dictionary in sets
        for border in sorted(_BORDERS, key=lambda one: one != grid.border_cells)
    ][1:]
    for other, seen in _readings(grey, others, settings):
        if len(seen.number) < min(_ENOUGH, grid.tag_count):
            continue
        placed = len(_placed(seen, grey, other, settings))
        if placed < min(_ENOUGH, grid.tag_count):
            continue
        tags = counted(placed, "tag")
        border = f"border_cells: {other.border_cells}"
        if other.dictionary == grid.dictionary:
            return Refusal.BORDER_CELLS, f"{tags} of {other.dictionary} with {border} are in place."
        detail = f"{tags} of {other.dictionary} are in place"
        detail += f" with {border}" if other.border_cells != grid.border_cells else ""
        return Refusal.NO_MARKERS, f"{detail}; the target has {grid.dictionary}."
    return None


def _readings(
    grey: GreyPicture, grids: list[AprilGrid], settings: DetectSettings
) -> Iterator[tuple[AprilGrid, SeenTags]]:
    """Return the tags of several grids that are read, at every level of a picture, coarse ones first."""
    for grid in grids if not grids[0].corner_squares else ():
        yield grid, read_bare_tags(grey, grid, settings)
    for level in reduced_pictures(grey, settings) if grids[0].corner_squares else ():
        saddles = unturned(find_saddles(level.grey, settings.saddle), settings)
        for grid in grids:
            tags = read_tags(level.grey, saddles, grid)
            yield grid, SeenTags(tags.number, level.in_full(tags.corners))
