"""Grid of spots that grows from a seed, without what is inconsistent, compiled."""

import numpy as np

from labcal.detect.compiled import compiled
from labcal.detect.lattice.growth import GrowthLimits, drop_inconsistent, extent, grow, keep_largest_part
from labcal.detect.lattice.neighbourhood import PredictionLimits


@compiled
def grown_from(
    seed: np.ndarray,
    spots: tuple[np.ndarray, np.ndarray],
    usable: np.ndarray,
    far: int,
    limits: tuple[GrowthLimits, PredictionLimits],
) -> np.ndarray:
    """Return the nodes and spots of the consistent grid that grows from a seed, row by row, shape (n, 3).

    Parameters
    ----------
    seed : ndarray of int, shape (m, 3)
        Nodes along a and b, and their spots.
    spots : tuple of ndarray
        Centres and radii of all spots, px.
    usable : ndarray of bool, shape (n,)
        Spots that may be taken.
    far : int
        Nodes to either side of the seed's middle.
    limits : tuple of GrowthLimits and PredictionLimits
    """
    centre, radius = spots
    grid = np.full((2 * far + 1, 2 * far + 1), -1)
    for k in range(len(seed)):
        grid[far + seed[k, 0], far + seed[k, 1]] = seed[k, 2]
        usable[seed[k, 2]] = False
    grow(grid, centre, radius, usable, limits)
    top, bottom, left, right = extent(grid)
    grid = grid[top : bottom + 1, left : right + 1].copy()
    drop_inconsistent(grid, centre, limits)
    keep_largest_part(grid, limits[0].part_gap_nodes)
    found, count = np.empty((grid.size, 3), dtype=np.int64), 0
    for a in range(grid.shape[0]):
        for b in range(grid.shape[1]):
            if grid[a, b] >= 0:
                found[count, 0], found[count, 1], found[count, 2] = a, b, grid[a, b]
                count += 1
    return found[:count].copy()
