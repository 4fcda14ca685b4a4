"""Tags that go on where an AprilGrid ends: its first id is another one."""

import numpy as np

from labcal.arrays import Pixels
from labcal.detect.corners.tag_codes import SeenTags
from labcal.detect.corners.tag_places import PlacedTags, corners_of_tags
from labcal.targets.april_grid import AprilGrid

_NEAR = 0.3
"""Distance of its corners from their prediction, of a side."""
_FEWEST = 2


def first_id_of_rows(seen: SeenTags, placed: PlacedTags, grid: AprilGrid) -> int | None:
    """Return the first id with which the tags of a picture are rows of the grid; None if it has these.

    A grid whose first id is a row too high is in place under the ids that it shares with the print: the tags
    of the row below go on at its lower end, and those of its last row are nowhere.

    Parameters
    ----------
    seen : SeenTags
    placed : PlacedTags
    grid : AprilGrid
    """
    known = np.array(sorted(placed.corners))
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


def _goes_on(number: int, corners: Pixels, placed: PlacedTags, grid: AprilGrid) -> bool:
    """Tell whether a tag is where the grid would have it with further rows."""
    row, col = divmod(number, grid.tag_cols)
    expected = placed.predicted(row, col, grid, corners_of_tags(grid, np.array([number]))[0])
    side = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1).min()
    return bool((np.linalg.norm(corners - expected, axis=1) < _NEAR * side).all())
