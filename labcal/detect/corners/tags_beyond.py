"""Tags that go on where an AprilGrid ends: its first id is another one."""

import numpy as np

from labcal.arrays import Pixels
from labcal.detect.corners.marker_places import through_markers
from labcal.detect.corners.tag_codes import SeenTags
from labcal.detect.corners.tag_places import corners_of_tags, tag_corners
from labcal.targets.april_grid import AprilGrid

_NEAREST = 3
"""Tags in place that predict one beyond."""
_NEAR = 0.3
"""Distance of its corners from their prediction, of a side."""
_FEWEST = 2


def first_id_of_rows(seen: SeenTags, placed: dict[int, Pixels], grid: AprilGrid) -> int | None:
    """Return the first id with which the tags of a picture are rows of the grid; None if it has these.

    A grid whose first id is a row too high is in place under the ids that it shares with the print: the tags
    of the row below go on at its lower end, and those of its last row are nowhere.

    Parameters
    ----------
    seen : SeenTags
    placed : dict of int to ndarray, shape (4, 2)
        Corners of the tags in place, px, by number.
    grid : AprilGrid
    """
    known = np.array(sorted(placed))
    rows = known // grid.tag_cols
    numbers = seen.number - grid.first_id
    foreign = np.flatnonzero((numbers < 0) | (numbers >= grid.tag_count))
    beyond = [
        int(numbers[k] // grid.tag_cols)
        for k in foreign.tolist()
        if _goes_on(int(numbers[k]), seen.corners[k], placed, grid)
    ]
    if len(beyond) < _FEWEST:
        return None
    lowest, highest = min(*beyond, int(rows.min())), max(*beyond, int(rows.max()))
    if highest - lowest >= grid.tag_rows:  # the print has more rows than the target, and may
        return None
    first = grid.first_id + grid.tag_cols * (lowest if lowest < 0 else highest - grid.tag_rows + 1)
    return first if first >= 0 else None


def _goes_on(number: int, corners: Pixels, placed: dict[int, Pixels], grid: AprilGrid) -> bool:
    """Tell whether a tag is where the grid would have it with further rows."""
    row, col = divmod(number, grid.tag_cols)
    known = np.array(sorted(placed))
    away = np.maximum(np.abs(known // grid.tag_cols - row), np.abs(known % grid.tag_cols - col))
    near = known[np.argsort(away, kind="stable")[:_NEAREST]]
    place = corners_of_tags(grid, np.array([number]))[0]
    expected = through_markers(np.array([placed[k] for k in near.tolist()]), tag_corners(grid)[near], place)
    side = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1).min()
    return bool((np.linalg.norm(corners - expected, axis=1) < _NEAR * side).all())
