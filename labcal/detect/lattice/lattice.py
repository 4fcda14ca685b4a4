"""Spots that form a grid: small crosses as seeds, grown node by node and checked against their neighbours."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from labcal.arrays import Pixels
from labcal.detect.lattice.grown_grid import grown_from
from labcal.detect.lattice.growth import GrowthLimits
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
            lattices += _grown(seed, (outlines.centre, radius), free, target, settings)
        elif seed is not None:
            doubtful.append(seed)
    for seed in sorted(doubtful, key=lambda seed: seed.misfit):
        if free[seed.middle] and len(lattices) < settings.max_lattices:
            lattices += _grown(seed, (outlines.centre, radius), free, target, settings)
    return sorted((Lattice(lattice.spots, undistortion) for lattice in lattices), key=len, reverse=True)


def _grown(
    seed: Seed, seen: tuple[Pixels, np.ndarray], free: np.ndarray, target: DotGrid, settings: GridSettings
) -> list[Lattice]:
    """Return the lattice that grows from a seed, or none, and take its spots.

    The spots that are seen have centres and radii, px.
    """
    centre, radius = seen
    # Radii of neighbours differ by this much as a rule, where one of them may be a ring.
    usual = settings.neighbour_radius_log + abs(float(np.log(target.ring_size)))
    similar = np.abs(np.log(radius / radius[seed.middle])) < settings.lattice_radius_factor * usual
    far = min(len(radius), settings.max_extent_factor * max(target.cols, target.rows))
    limits = settings.limits(GrowthLimits), settings.limits(PredictionLimits)
    begin = np.array([(a, b, spot) for (a, b), spot in seed.spots.items() if free[spot]]).reshape(-1, 3)
    found = grown_from(begin, (centre, radius), free & similar, far, limits)
    free[seed.middle] = False
    free[found[:, 2]] = False
    spots = {(a, b): spot for a, b, spot in found.tolist()}
    return [Lattice(spots)] if spots else []
