"""Spots that form a grid: small crosses as seeds, grown node by node and checked against their neighbours."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from labcal.detect.lattice.growth import GrowthLimits, drop_inconsistent, grow, keep_largest_part
from labcal.detect.lattice.neighbourhood import PredictionLimits
from labcal.detect.lattice.rough_undistortion import NONE, RoughUndistortion
from labcal.detect.lattice.seeds import Seed, seed_at
from labcal.detect.outlines.outlines import Outlines
from labcal.detect.stage_settings.grid import GridSettings
from labcal.targets.grid import DotGrid

Node = tuple[int, int]


@dataclass(frozen=True)
class Lattice:
    """Spots on grid nodes; the numbering is right up to a shift and a quarter turn, and never mirrored."""

    spots: dict[Node, int]
    undistortion: RoughUndistortion = NONE
    """The map under which the grid's lines are straight."""

    @cached_property
    def nodes(self) -> np.ndarray:
        """The nodes, shape (n, 2)."""
        return np.array(list(self.spots), dtype=np.int64).reshape(-1, 2)

    @cached_property
    def numbers(self) -> np.ndarray:
        """The numbers of the spots, shape (n,)."""
        return np.array(list(self.spots.values()), dtype=np.int64)

    def __len__(self) -> int:
        """Return the number of nodes that hold a spot."""
        return len(self.spots)


def find_lattices(
    outlines: Outlines, target: DotGrid, undistortion: RoughUndistortion, settings: GridSettings
) -> list[Lattice]:
    """Return the grids that the spots form in an undistorted picture, largest first.

    Nodes are numbered from a seed's middle so that the first axis turned by 90 degrees anticlockwise in the
    picture gives the second, as the columns and rows of a board seen from its front.
    """
    outlines = undistortion.outlines(outlines)
    radius = outlines.radius
    order = np.argsort(-radius, kind="stable")[: settings.max_outlines]
    free = np.zeros(len(radius), dtype=bool)
    free[order] = True
    lattices: list[Lattice] = []
    doubtful: list[Seed] = []
    for i in order[:: max(1, len(order) // settings.max_seeds)]:
        if not free[i] or len(lattices) == settings.max_lattices:
            continue
        seed = seed_at(int(i), outlines, target, radius, settings)
        if seed is not None and seed.misfit < settings.good_seed_steps:
            lattices += _grown(seed, outlines, free, target, settings)
        elif seed is not None:
            doubtful.append(seed)
    for seed in sorted(doubtful, key=lambda seed: seed.misfit):
        if free[seed.middle] and len(lattices) < settings.max_lattices:
            lattices += _grown(seed, outlines, free, target, settings)
    return sorted((Lattice(lattice.spots, undistortion) for lattice in lattices), key=len, reverse=True)


def _grown(
    seed: Seed, outlines: Outlines, free: np.ndarray, target: DotGrid, settings: GridSettings
) -> list[Lattice]:
    """Return the lattice that grows from a seed, or none, and take its spots."""
    centre, radius = outlines.centre, outlines.radius
    # Radii of neighbours differ by this much as a rule, where one of them may be a ring.
    usual = settings.neighbour_radius_log + abs(float(np.log(target.ring_size)))
    similar = np.abs(np.log(radius / radius[seed.middle])) < settings.lattice_radius_factor * usual
    far = min(len(radius), settings.max_extent_factor * max(target.cols, target.rows))
    grid = np.full((2 * far + 1, 2 * far + 1), -1)
    usable = free & similar
    for (a, b), spot in seed.spots.items():
        if free[spot]:
            grid[far + a, far + b] = spot
            usable[spot] = False
    limits = settings.limits(GrowthLimits), settings.limits(PredictionLimits)
    grow(grid, centre, radius, usable, limits)
    nodes = np.argwhere(grid >= 0)
    low, high = nodes.min(axis=0), nodes.max(axis=0)
    grid = np.ascontiguousarray(grid[low[0] : high[0] + 1, low[1] : high[1] + 1])
    drop_inconsistent(grid, centre, limits)
    keep_largest_part(grid, settings.part_gap_nodes)
    spots = {(int(a), int(b)): int(grid[a, b]) for a, b in np.argwhere(grid >= 0)}
    free[seed.middle] = False
    free[list(spots.values())] = False
    return [Lattice(spots)] if spots else []
