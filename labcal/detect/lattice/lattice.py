"""Spots that form a grid: small crosses as seeds, grown node by node and checked against their neighbours."""

from dataclasses import dataclass

import numpy as np

from labcal.detect.lattice.flattening import NONE, Flattening
from labcal.detect.lattice.grid_kernel import drop_inconsistent, grow, keep_largest_part
from labcal.detect.lattice.seeds import Seed, seed_at
from labcal.detect.outlines.outlines import Outlines
from labcal.targets.grid import DotGrid

Node = tuple[int, int]

_SIZE_TOLERANCE = 0.35  # in the logarithm of the radius, between neighbours
_SEED_TOLERANCE = 0.7  # the same for what may lie around a seed, near a camera
_GROW_TOLERANCE = 0.8  # and for what a grid may take up, where its neighbours expect it
_GOOD_SEED = 0.06  # of a step: a seed that fits so well is grown at once
_MOST_SPOTS = 4000  # beyond this the smallest are left out
_MOST_SEEDS = 600  # looked for, in a picture full of what is no grid
_MOST_COMPONENTS = 12
_FARTHEST = 2  # nodes from a seed, over those of the declared grid's longer side
_GAP = 5  # steps over hidden nodes, at most, between what hangs together


@dataclass(frozen=True)
class Lattice:
    """Spots on grid nodes; the numbering is right up to a shift and a quarter turn, and never mirrored."""

    spots: dict[Node, int]
    flattening: Flattening = NONE
    """What made the grid's lines straight."""

    def __len__(self) -> int:
        """Return the number of nodes that hold a spot."""
        return len(self.spots)


def size_tolerance(target: DotGrid) -> float:
    """Return by how much the logarithms of the radii of two neighbours may differ."""
    return _SIZE_TOLERANCE + abs(float(np.log(target.ring_size)))


def find_lattices(outlines: Outlines, target: DotGrid, flattening: Flattening) -> list[Lattice]:
    """Return the grids that the spots form in a flattened picture, largest first.

    Nodes are numbered from a seed's middle so that the first axis turned by 90 degrees anticlockwise in the
    picture gives the second, as the columns and rows of a board seen from its front.
    """
    outlines = flattening.outlines(outlines)
    radius = outlines.radius
    order = np.argsort(-radius, kind="stable")[:_MOST_SPOTS]
    tolerance = size_tolerance(target)
    free = np.zeros(len(radius), dtype=bool)
    free[order] = True
    lattices: list[Lattice] = []
    doubtful: list[Seed] = []
    for i in order[:: max(1, len(order) // _MOST_SEEDS)]:
        if not free[i] or len(lattices) == _MOST_COMPONENTS:
            continue
        near = np.flatnonzero(np.abs(np.log(radius / radius[i])) < _SEED_TOLERANCE)
        seed = seed_at(int(i), outlines, target, near[near != i])
        if seed is not None and seed.misfit < _GOOD_SEED:
            lattices += _grown(seed, outlines, free, tolerance, max(target.cols, target.rows))
        elif seed is not None:
            doubtful.append(seed)
    for seed in sorted(doubtful, key=lambda seed: seed.misfit):
        if free[seed.middle] and len(lattices) < _MOST_COMPONENTS:
            lattices += _grown(seed, outlines, free, tolerance, max(target.cols, target.rows))
    return sorted((Lattice(lattice.spots, flattening) for lattice in lattices), key=len, reverse=True)


def _grown(seed: Seed, outlines: Outlines, free: np.ndarray, tolerance: float, most: int) -> list[Lattice]:
    """Return the lattice that grows from a seed, or none, and take its spots; `most` as the longer side."""
    centre, radius = outlines.centre, outlines.radius
    similar = np.abs(np.log(radius / radius[seed.middle])) < 3 * tolerance
    far = min(len(radius), _FARTHEST * most)
    grid = np.full((2 * far + 1, 2 * far + 1), -1)
    usable = free & similar
    for (a, b), spot in seed.spots.items():
        if free[spot]:
            grid[far + a, far + b] = spot
            usable[spot] = False
    grow(grid, centre, radius, usable, _GROW_TOLERANCE)
    nodes = np.argwhere(grid >= 0)
    low, high = nodes.min(axis=0), nodes.max(axis=0)
    grid = np.ascontiguousarray(grid[low[0] : high[0] + 1, low[1] : high[1] + 1])
    drop_inconsistent(grid, centre)
    keep_largest_part(grid, _GAP)
    spots = {(int(a), int(b)): int(grid[a, b]) for a, b in np.argwhere(grid >= 0)}
    free[seed.middle] = False
    free[list(spots.values())] = False
    return [Lattice(spots)] if spots else []
