"""Lattices of saddle points: crosses along their edges as seeds, grown as grids of dots are."""

import numpy as np
from scipy.spatial import cKDTree

from labcal.detect.corners.node_grid import ahead, behind
from labcal.detect.corners.saddle_crosses import CrossLimits, saddle_crosses
from labcal.detect.corners.saddles import Saddles
from labcal.detect.lattice.growth import GrowthLimits, drop_inconsistent, grow, keep_largest_part
from labcal.detect.lattice.lattice import Lattice, Node
from labcal.detect.lattice.neighbourhood import PredictionLimits
from labcal.detect.lattice.rough_undistortion import RoughUndistortion
from labcal.detect.settings import DetectSettings

_NEIGHBOURS = 48
"""Saddle points looked at around one: blurred codes beside a corner have up to thirty."""
_STEPS: tuple[Node, ...] = ((1, 0), (-1, 0), (0, 1), (0, -1))


def find_board_lattices(
    saddles: Saddles, longest: int, undistortion: RoughUndistortion, settings: DetectSettings
) -> list[Lattice]:
    """Return the lattices that saddle points form, largest first.

    The first axis turned by 90 degrees anticlockwise in the picture gives the second, as the columns and rows
    of a board seen from its front. Colours alternate from node to node.

    Parameters
    ----------
    saddles : Saddles
    longest : int
        Corners along the longer side of the board.
    undistortion : RoughUndistortion
        Under which lines are straight.
    settings : DetectSettings
    """
    if len(saddles.place) < settings.saddle.min_corners:
        return []
    arms, misfit = _crosses(saddles, settings)
    free = np.ones(len(saddles.place), dtype=bool)
    flat = undistortion.undistort(saddles.place)
    limits = settings.grid.limits(GrowthLimits), settings.grid.limits(PredictionLimits)
    far = settings.grid.max_extent_factor * longest
    lattices: list[Lattice] = []
    faintest = np.minimum(saddles.step, saddles.step[arms].min(axis=1))
    seeds = [int(i) for i in np.argsort(-faintest, kind="stable") if np.isfinite(misfit[i])]
    for i in seeds[: settings.saddle.max_seeds]:
        if not free[[i, *arms[i]]].all() or len(lattices) == settings.saddle.max_lattices:
            continue
        grid = np.full((2 * far + 1, 2 * far + 1), -1)
        grid[far, far] = i
        for (a, b), spot in zip(_STEPS, arms[i], strict=True):
            grid[far + a, far + b] = spot
        usable = free & (saddles.step > settings.saddle.min_step_share * faintest[i])
        usable[[i, *arms[i]]] = False
        grow(grid, flat, saddles.step, usable, limits)
        if len(dropped := _drop_wrong_colours(grid, saddles)) > 0:
            # Behind a fisheye tilted squares shrink so fast that few nodes predict the line after next.
            usable[dropped] = True
            grow(grid, flat, saddles.step, usable, limits)
            _drop_wrong_colours(grid, saddles)
        grid = _cropped(grid)
        drop_inconsistent(grid, flat, limits)
        keep_largest_part(grid, settings.grid.part_gap_nodes)
        spots = {(int(a), int(b)): int(grid[a, b]) for a, b in np.argwhere(grid >= 0)}
        free[[i, *spots.values()]] = False
        if len(spots) >= settings.saddle.min_corners:
            lattices.append(Lattice(spots, undistortion))
    return sorted(lattices, key=len, reverse=True)


def _crosses(saddles: Saddles, settings: DetectSettings) -> tuple[np.ndarray, np.ndarray]:
    """Return the next corners along both edges, (n, 4), and their misfit; infinite where one is missing."""
    n = len(saddles.place)
    near = cKDTree(saddles.place).query(saddles.place, k=min(_NEIGHBOURS + 1, n))[1][:, 1:]
    seen = (saddles.place, saddles.edges, saddles.white_between, saddles.step)
    return saddle_crosses(seen, near, settings.saddle.limits(CrossLimits))


def _cropped(grid: np.ndarray) -> np.ndarray:
    """Return the part of a grid that holds spots; one empty node if there are none."""
    nodes = np.argwhere(grid >= 0)
    if len(nodes) == 0:
        return np.full((1, 1), -1)
    low, high = nodes.min(axis=0), nodes.max(axis=0)
    return np.ascontiguousarray(grid[low[0] : high[0] + 1, low[1] : high[1] + 1])


def lattice_colours(grid: np.ndarray, saddles: Saddles) -> np.ndarray:
    """Return 1 where the square between a node's two axes is white, -1 where it is black, 0 where unknown.

    Parameters
    ----------
    grid : ndarray of int, shape (a, b)
        Saddle points by node, -1 where there is none.
    saddles : Saddles
    """
    known = grid >= 0
    place = np.full((*grid.shape, 2), np.nan)
    place[known] = saddles.place[grid[known]]
    way = np.zeros((*grid.shape, 2))
    has = known.copy()
    for axis in (0, 1):
        after, before = ahead(place, axis), behind(place, axis)
        step = np.where(np.isfinite(after), after, before)
        has &= np.isfinite(step[..., 0])
        way += np.nan_to_num(step / np.linalg.norm(step, axis=-1, keepdims=True))
    colours = np.zeros(grid.shape, dtype=np.int64)
    white = saddles.is_white(grid[has], np.arctan2(way[has, 1], way[has, 0]))
    colours[has] = np.where(white, 1, -1)
    return colours


def _drop_wrong_colours(grid: np.ndarray, saddles: Saddles) -> np.ndarray:
    """Take out, in place, and return the nodes whose colours do not alternate with those of most others."""
    a, b = np.indices(grid.shape)
    phase = lattice_colours(grid, saddles) * np.where((a + b) % 2 == 0, 1, -1)
    wrong = (phase != 0) & (phase != np.sign(phase.sum()))
    dropped = np.asarray(grid[wrong])
    grid[wrong] = -1
    return dropped
